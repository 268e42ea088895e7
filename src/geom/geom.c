/* geom.c - see geom.h
 *
 * Each surface is compiled into a struct rad_prim; a tree is built over these,
 * and they are put in its order.
 *
 * The tie rule must not depend on the order of traversal, so it takes two
 * walks.  The first one finds the nearest hit, and notes whether another hit
 * lies in a narrow window behind it.  The window depends on ray and distance
 * alone, so the answer is the same whichever hit is found first.  If there is
 * one, which is rare, a second walk offers every hit within the nearest one's
 * error bound, and the best by rank is kept.
 *
 * Each part of the scene gets a set of its own, made after the parts that it
 * holds copies of. */
#include "config.h"

#include "geom/geom.h"

#include "base/arena.h"
#include "base/vec.h"
#include "base/xform.h"
#include "geom/kernel.h"
#include "geom/line.h"
#include "scene/overlap.h"
#include "scene/part.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const struct rad_kernel *
best_kernel(void)
{
    const struct rad_kernel *const *k = rad_kernels();

    while (!(*k)->usable())
        k++;
    return *k;
}

/* A set to be made, of objects `first` to `first` + n - 1. */
struct making {
    struct rad_geom *g;
    struct rad_set *set;
    int32_t first, n;
    const uint8_t *surf; /* by object */
    uint32_t rays;       /* rad_geom_new() */
};

static bool
make_prim(const struct making *mk, struct rad_prim *p, int32_t i, bool *nomem)
{
    const struct rad_object *o = &mk->g->scene->objects[i];

    if (!o->use)
        return rad_prim_make(p, o, &mk->g->arena, nomem);
    return rad_place_make(p, o, &mk->g->sets[o->use->part->index], mk->surf[i],
                          mk->set->nplaces + 1, &mk->g->arena, nomem);
}

/* Refuse an instance or mesh whose file was not read. */
static int
check_use(const struct making *mk, int32_t i, struct rad_error *err)
{
    const struct rad_object *o = &mk->g->scene->objects[i];

    if (o->use || (o->type != RAD_INSTANCE && o->type != RAD_MESH))
        return 0;
    return rad_scene_fail(mk->g->scene, o, err, RAD_EDATA,
                          "its file has not been read");
}

/* Compile all surfaces, in the scene's order. */
static int
make_prims(const struct making *mk, struct rad_error *err)
{
    for (int32_t i = mk->first; i < mk->first + mk->n; i++) {
        struct rad_prim *p = &mk->set->prims[mk->set->nprims];
        bool nomem = false;
        int rc = check_use(mk, i, err);

        if (rc)
            return rc;
        if (!make_prim(mk, p, i, &nomem)) {
            if (nomem)
                return rad_fail_memory(err);
            continue;
        }
        p->obj = i;
        if (p->kind == PRIM_PLACE)
            mk->set->nplaces++;
        else
            p->surf = mk->surf[i];
        mk->set->nprims++;
    }
    return 0;
}

/* Put the prims in the tree's order, cycle by cycle; overwrites order. */
static void
reorder(struct rad_set *set, uint32_t *order)
{
    for (uint32_t i = 0; i < set->nprims; i++) {
        struct rad_prim held = set->prims[i];
        uint32_t to = i, from;

        while ((from = order[to]) != i) {
            set->prims[to] = set->prims[from];
            order[to] = to;
            to = from;
        }
        set->prims[to] = held;
        order[to] = to;
    }
}

/* Lay out the faces' vertices in the tree's order, in which they are read. */
static int
lay_polygons(const struct making *mk, struct rad_error *err)
{
    for (uint32_t i = 0; i < mk->set->nprims; i++) {
        struct rad_prim *p = &mk->set->prims[i];
        double *room;

        if (p->kind != PRIM_POLYGON && p->kind != PRIM_WARPED)
            continue;
        room =
            rad_arena_alloc(&mk->g->arena, rad_polygon_room(p) * sizeof *room);
        if (!room)
            return rad_fail_memory(err);
        rad_polygon_lay(p, room);
    }
    return 0;
}

/* List the places of a set by their numbers, and check that one number can tell
 * all copies apart. */
static int
list_places(struct rad_geom *g, struct rad_set *set, struct rad_error *err)
{
    double most = 1;

    set->copies = 1;
    if (set->nplaces == 0)
        return 0;
    set->places =
        rad_arena_calloc(&g->arena, set->nplaces, sizeof *set->places);
    if (!set->places)
        return rad_fail_memory(err);
    for (uint32_t i = 0; i < set->nprims; i++)
        if (set->prims[i].kind == PRIM_PLACE) {
            const struct rad_place *pl = set->prims[i].place;

            set->places[pl->number - 1] = pl;
            most = rad_most(most, pl->set->copies);
        }
    set->copies = 1 + set->nplaces * most;
    if (!(set->copies < RAD_GEOM_COPIES))
        return rad_fail(err, RAD_EDATA,
                        "instances within instances make more than 2^64 "
                        "copies");
    return 0;
}

static void
prim_item_bounds(const void *arg, uint32_t i, struct rad_box *box)
{
    const struct rad_prim *prims = arg;

    rad_prim_bounds(&prims[i], box);
}

static int
make_set(const struct making *mk, struct rad_error *err)
{
    struct rad_set *set = mk->set;
    struct rad_bvh_items items = { .bounds = prim_item_bounds,
                                   .rays = mk->rays };
    uint32_t *order;
    size_t n = 1; /* one more, for a prim that is tried and left out */
    int rc;

    for (int32_t i = mk->first; i < mk->first + mk->n; i++)
        n += rad_prim_has(mk->g->scene->objects[i].type);
    set->prims = malloc(n * sizeof *set->prims);
    order = malloc(n * sizeof *order);
    rc = set->prims && order ? make_prims(mk, err) : rad_fail_memory(err);
    items.arg = set->prims;
    items.n = set->nprims;
    if (!rc)
        rc = rad_bvh_build(&set->bvh, &items, order, err);
    if (!rc) {
        reorder(set, order);
        rc = lay_polygons(mk, err);
    }
    if (!rc)
        rc = list_places(mk->g, set, err);
    free(order);
    return rc;
}

/* Index the scene's own surfaces by their objects. */
static int
index_prims(struct rad_geom *g, int32_t n, struct rad_error *err)
{
    g->nown = n;
    g->prim_of = malloc(((size_t)n + 1) * sizeof *g->prim_of);
    if (!g->prim_of)
        return rad_fail_memory(err);
    for (int32_t i = 0; i < n; i++)
        g->prim_of[i] = RAD_NO_PRIM;
    for (uint32_t i = 0; i < g->top.nprims; i++)
        g->prim_of[g->top.prims[i].obj] = i;
    return 0;
}

static int
make_part(struct rad_geom *g, const struct rad_part *part, const uint8_t *surf,
          uint32_t rays, struct rad_error *err)
{
    struct rad_set *set = &g->sets[part->index];
    struct making mk = { g, set, part->first, part->n, surf, rays };

    return part->mesh ? rad_meshed_make(set, part, surf, rays, err)
                      : make_set(&mk, err);
}

/* Make the sets of the parts by depth, so that copied parts come first. */
static int
make_parts(struct rad_geom *g, const uint8_t *surf, uint32_t rays,
           struct rad_error *err)
{
    const struct rad_scene *s = g->scene;
    int32_t left = s->nparts;
    int rc = 0;

    g->sets = calloc((size_t)s->nparts + 1, sizeof *g->sets);
    if (!g->sets)
        return rad_fail_memory(err);
    for (int depth = 0; left > 0 && !rc; depth++)
        for (int32_t i = 0; i < s->nparts && !rc; i++)
            if (s->parts[i]->depth == depth) {
                rc = make_part(g, s->parts[i], surf, rays, err);
                left--;
            }
    return rc;
}

static int
compile(struct rad_geom *g, const uint8_t *surf, uint32_t rays,
        struct rad_error *err)
{
    struct making mk = { g, &g->top, 0, rad_scene_own(g->scene), surf, rays };
    int rc = make_parts(g, surf, rays, err);

    if (!rc)
        rc = make_set(&mk, err);
    for (uint32_t i = 0; i < g->top.nprims; i++)
        g->passes |=
            (g->top.prims[i].surf & (RAD_SURF_PASSED | RAD_SURF_ONESIDED)) != 0;
    return rc ? rc : index_prims(g, mk.n, err);
}

struct rad_geom *
rad_geom_new(const struct rad_scene *scene, const uint8_t *surf, uint32_t rays,
             struct rad_error *err)
{
    struct rad_geom *g = calloc(1, sizeof *g);

    if (!g) {
        rad_fail_memory(err);
        return NULL;
    }
    rad_arena_init(&g->arena);
    g->scene = scene;
    g->kernel = best_kernel();
    if (compile(g, surf, rays, err) < 0) {
        rad_geom_free(g);
        return NULL;
    }
    return g;
}

static void
release_set(struct rad_set *set)
{
    rad_bvh_release(&set->bvh);
    free(set->prims);
    rad_meshed_free(set->meshed);
}

void
rad_geom_free(struct rad_geom *g)
{
    if (!g)
        return;
    release_set(&g->top);
    for (int32_t i = 0; g->sets && i < g->scene->nparts; i++)
        release_set(&g->sets[i]);
    rad_arena_release(&g->arena);
    free(g->sets);
    free(g->prim_of);
    free(g);
}

void
rad_geom_use(struct rad_geom *g, const struct rad_kernel *k)
{
    g->kernel = k;
}

void
rad_geom_bounds(const struct rad_geom *g, double lo[3], double hi[3])
{
    rad_copy(lo, g->top.bvh.lo);
    rad_copy(hi, g->top.bvh.hi);
}

bool
rad_geom_place(const struct rad_hit *hit, struct rad_xform *move)
{
    const struct rad_set *set;
    uint64_t copy = hit->copy;

    if (!hit->in)
        return false;
    rad_xform_identity(move);
    set = &hit->in->top;
    while (copy != 0) {
        const struct rad_place *pl = set->places[(copy - 1) % set->nplaces];

        rad_xform_then(move, &pl->use->move, move);
        copy = (copy - 1) / set->nplaces;
        set = pl->set;
    }
    return true;
}

double
rad_geom_size(const struct rad_geom *g, const struct rad_hit *hit)
{
    struct rad_extent e;

    if (hit->in) {
        const struct rad_set *set = &hit->in->top;
        const struct rad_use *use =
            set->places[(hit->copy - 1) % set->nplaces]->use;

        return use->part->size * use->move.scale;
    }
    return rad_extent_of(&g->scene->objects[hit->obj], &e)
               ? sqrt(rad_dist2(e.lo, e.hi))
               : 0;
}

/* Set up the probe; false: the span is no ray (it has a NaN or an infinity). */
static bool
probe_span(struct rad_probe *probe, const struct rad_span *span)
{
    const double *d = span->dir;
    double len = fabs(d[0]) + fabs(d[1]) + fabs(d[2]);

    rad_probe_init(probe, span);
    return (probe->size + len < INFINITY) & (len > 0) &
           (span->tmin < span->tmax);
}

/* Set up a walk over the scene's own surfaces; false: the span is no ray. */
static bool
walk_init(struct rad_walk *w, const struct rad_geom *g,
          const struct rad_span *span)
{
    if (!probe_span(&w->probe, span))
        return false;
    rad_walk_start(w, g, &g->top);
    w->tmin = span->tmin;
    w->tmax = span->tmax < DBL_MAX ? span->tmax : DBL_MAX;
    w->cut = w->tmax;
    return true;
}

static void
add_counts(struct rad_geom_counts *counts, const struct rad_walk *w)
{
    counts->tests += w->tests;
    counts->nodes += w->nodes;
}

/* Does hit a win over hit b in the same place?  Radiance's rules come first,
 * then numbers, so that the answer is definite. */
static bool
outranks(const struct rad_geom *g, const struct rad_met *a, bool a_front,
         const struct rad_met *b, bool b_front)
{
    int32_t amod = g->scene->objects[a->hit.obj].modifier;
    int32_t bmod = g->scene->objects[b->hit.obj].modifier;
    int ka = a->surf & (RAD_SURF_NOMATERIAL | RAD_SURF_TRANSPARENT);
    int kb = b->surf & (RAD_SURF_NOMATERIAL | RAD_SURF_TRANSPARENT);

    if (ka != kb) /* NOMATERIAL is the higher bit: having none is worse */
        return ka < kb;
    if (a_front != b_front)
        return a_front;
    /* a copy's modifiers come last, wherever its file is named */
    if (!a->hit.in != !b->hit.in && (a->hit.in ? b : a)->surf & RAD_SURF_LAMP)
        return !a->hit.in;
    if (amod != bmod)
        return amod > bmod;
    if (a->hit.obj != b->hit.obj)
        return a->hit.obj > b->hit.obj;
    if (a->obj != b->obj)
        return a->obj > b->obj;
    if (a->hit.in && b->hit.in && a->hit.copy != b->hit.copy)
        return a->hit.copy > b->hit.copy;
    return a->number > b->number;
}

bool
rad_geom_outranks(const struct rad_geom *g, int32_t a, int32_t b)
{
    struct rad_met met[2] = { { .hit.obj = a, .obj = a },
                              { .hit.obj = b, .obj = b } };

    for (int i = 0; i < 2; i++) {
        uint32_t prim = g->prim_of[met[i].obj];

        if (prim == RAD_NO_PRIM)
            return false;
        met[i].surf = g->top.prims[prim].surf;
    }
    return outranks(g, &met[0], true, &met[1], true);
}

struct contest {
    const struct rad_geom *g;
    struct rad_met leader;
    struct rad_met lamp; /* behind the leader, but flush with it */
    bool lit;            /* there is such a lamp */
    double first, end;   /* the nearest hit, and where its ties end */
};

/* Is met the front of a lamp that may be in one plane with the nearest hit? */
static bool
is_flush_lamp(const struct contest *c, const struct rad_met *met,
              const struct rad_walk *w)
{
    const double *n = met->hit.n;
    double slope = -rad_dot(n, w->probe.dir);
    double gap = RAD_GEOM_FLUSH * rad_dot_sizes(n, met->hit.p);

    return met->surf & RAD_SURF_LAMP && slope > 0 &&
           (met->hit.t - c->first) * slope < gap;
}

static void
offer(struct rad_walk *w, const struct rad_met *met)
{
    struct contest *c = w->arg;
    struct rad_met *best = &c->leader;

    if (!(met->hit.t < c->end)) {
        if (!is_flush_lamp(c, met, w))
            return;
        best = &c->lamp;
    }
    if ((best == &c->lamp && !c->lit) ||
        outranks(c->g, met, rad_dot(met->hit.n, w->probe.dir) < 0, best,
                 rad_dot(best->hit.n, w->probe.dir) < 0))
        *best = *met;
    c->lit |= best == &c->lamp;
}

/* Does the lamp behind the leader win? */
static bool
lamp_wins(const struct contest *c, const struct rad_walk *w)
{
    const struct rad_met *first = &c->leader;

    return c->lit && first->surf & RAD_SURF_OPAQUE &&
           !(first->surf & RAD_SURF_LAMP) &&
           outranks(c->g, &c->lamp, true, first,
                    rad_dot(first->hit.n, w->probe.dir) < 0);
}

/* Let the tie rule choose among the hits within the nearest hit's error, and
 * lamps that are flush with it. */
static void
settle_tie(const struct rad_geom *g, struct rad_walk *w, struct rad_hit *hit)
{
    struct contest c = { .g = g, .first = w->best };
    double slope, reach = w->cut - w->best;

    if (w->prims[w->prim].kind == PRIM_PLACE)
        c.leader = w->met;
    else
        rad_walk_met(w, w->prim, w->best, &c.leader);
    /* along the ray an error of the surface's place counts 1/cos times; stay
     * within the window, in which the first walk saw all hits */
    slope = fabs(rad_dot(hit->n, w->probe.dir));
    if (rad_least(hit->err, reach) < reach * slope)
        reach = rad_least(hit->err, reach) / slope;
    c.end = rad_least(nextafter(w->best + reach, INFINITY), w->tmax);
    w->cut = rad_most(w->cut, c.end);
    w->offer = offer;
    w->arg = &c;
    g->kernel->all(w);
    *hit = lamp_wins(&c, w) ? c.lamp.hit : c.leader.hit;
}

/* The hit that the walk found, if any, with ties settled. */
static inline void
take_met(const struct rad_geom *g, struct rad_walk *w, struct rad_hit *hit)
{
    const struct rad_prim *p;

    if (w->prim == RAD_NO_PRIM)
        return;
    p = &w->prims[w->prim];
    if (p->kind == PRIM_PLACE)
        *hit = w->met.hit;
    else
        rad_prim_surface(p, &w->probe, w->best, hit);
    if (w->tie)
        settle_tie(g, w, hit);
}

bool
rad_geom_nearest(const struct rad_geom *g, const struct rad_span *span,
                 struct rad_hit *hit, struct rad_geom_counts *counts)
{
    struct rad_walk w;

    hit->obj = RAD_VOID;
    if (!walk_init(&w, g, span))
        return false;
    g->kernel->nearest(&w);
    take_met(g, &w, hit);
    add_counts(counts, &w);
    return hit->obj != RAD_VOID;
}

static void
start_line(struct rad_walk *w, struct rad_line *line)
{
    line->n = 0;
    line->open = false;
    w->line = line;
}

/* Make the line empty, as if it had not been looked for. */
static void
forget_line(struct rad_line *line)
{
    line->n = 0;
    line->open = true;
}

bool
rad_geom_first(const struct rad_geom *g, const struct rad_span *span,
               struct rad_hit *hit, struct rad_line *line,
               struct rad_geom_counts *counts)
{
    struct rad_walk w;

    if (!g->passes) {
        forget_line(line);
        return rad_geom_nearest(g, span, hit, counts);
    }
    hit->obj = RAD_VOID;
    if (!walk_init(&w, g, span)) {
        forget_line(line);
        return false;
    }
    start_line(&w, line);
    g->kernel->along(&w);
    rad_line_end(&w);
    take_met(g, &w, hit);
    add_counts(counts, &w);
    return hit->obj != RAD_VOID;
}

/* Does the object that blocked last block again? */
static bool
still_blocks(const struct rad_geom *g, struct rad_walk *w, int32_t obj)
{
    const struct rad_prim *p;
    double t[2];

    if (obj < 0 || obj >= g->nown || obj == w->skip ||
        g->prim_of[obj] == RAD_NO_PRIM)
        return false;
    p = &g->top.prims[g->prim_of[obj]];
    if (!(p->surf & RAD_SURF_OPAQUE))
        return false;
    if (p->kind == PRIM_PLACE)
        return rad_place_meet(w, g->prim_of[obj], RAD_MEET_ANY);
    return g->kernel->one(w, p, t);
}

/* Does something opaque stop w's walk?  If blocker is given, the counts must
 * not depend on what it remembers: a blocked span counts as one test. */
static bool
is_blocked(const struct rad_geom *g, struct rad_walk *w, int32_t skip,
           int32_t *blocker)
{
    bool blocked;

    w->skip = skip;
    if (!blocker)
        return g->kernel->any(w);
    blocked = still_blocks(g, w, *blocker);
    w->tests = w->nodes = 0;
    if (!blocked && g->kernel->any(w)) {
        *blocker = w->prims[w->prim].obj;
        blocked = true;
    }
    if (blocked) {
        w->tests = 1;
        w->nodes = 0;
    }
    return blocked;
}

/* Add the target at the end of w's line, if it lies clearly behind all surfaces
 * in the line. */
static void
end_at_target(const struct rad_geom *g, struct rad_walk *w, int32_t target,
              struct rad_geom_counts *counts)
{
    struct rad_line *line = w->line;
    bool whole = !line->open && line->n < RAD_LINE_MOST;
    double t[2], last = line->at[line->n - 1].t;
    uint32_t i;

    line->open = true;
    if (!whole || target < 0 || target >= g->nown)
        return;
    i = g->prim_of[target];
    w->cut = DBL_MAX;
    counts->tests++;
    if (i == RAD_NO_PRIM || !g->kernel->one(w, &w->prims[i], t) ||
        !(*t - last > rad_walk_window(w, last)))
        return;
    line->at[line->n].t = *t;
    line->at[line->n++].item = i;
}

enum rad_sight
rad_geom_sight(const struct rad_geom *g, const struct rad_span *span,
               int32_t skip, int32_t *blocker, struct rad_hit *hit,
               struct rad_line *line, struct rad_geom_counts *counts)
{
    struct rad_walk w;
    bool blocked;

    if (!walk_init(&w, g, span))
        return RAD_SIGHT_CLEAR;
    start_line(&w, line);
    blocked = is_blocked(g, &w, skip, blocker);
    add_counts(counts, &w);
    if (blocked)
        return RAD_SIGHT_BLOCKED;
    if (!w.veiled)
        return RAD_SIGHT_CLEAR;
    /* nothing is opaque, so the first surface noted is the nearest, unless some
     * are in places or the tie rule has to choose */
    if (!w.vague && !rad_line_untie(&w)) {
        if (span->tmax < INFINITY)
            end_at_target(g, &w, skip, counts);
        rad_prim_surface(&w.prims[line->at[0].item], &w.probe, line->at[0].t,
                         hit);
        return RAD_SIGHT_VEILED;
    }
    forget_line(line);
    return rad_geom_nearest(g, span, hit, counts) ? RAD_SIGHT_VEILED
                                                  : RAD_SIGHT_CLEAR;
}

bool
rad_geom_hit_object(const struct rad_geom *g, int32_t obj,
                    const struct rad_span *span, struct rad_hit *hit,
                    struct rad_geom_counts *counts)
{
    const struct rad_prim *p;
    struct rad_walk w;
    double t[2];

    hit->obj = RAD_VOID;
    if (obj < 0 || obj >= g->nown || g->prim_of[obj] == RAD_NO_PRIM ||
        !probe_span(&w.probe, span))
        return false;
    p = &g->top.prims[g->prim_of[obj]];
    counts->tests++;
    w.tmin = span->tmin;
    w.cut = rad_least(span->tmax, DBL_MAX);
    if (!g->kernel->one(&w, p, t))
        return false;
    rad_prim_surface(p, &w.probe, *t, hit);
    return true;
}

/* A point is drawn back along the ray that hit until it is so many error bounds
 * in front of the surface, but at most by RAD_GEOM_BACK, and not behind the
 * ray's origin: in a corner another wall may be near behind that.  It is moved
 * along the normal only by the part of two bounds that is lacking then: at an
 * edge of less than 90 degrees the normal leads out through the other wall. */
#define DRAWN_BACK 4

void
rad_geom_leave(const struct rad_hit *hit, const double dir[3], double org[3])
{
    double side = rad_dot(hit->n, dir), way[3], cos_i, off = 2 * hit->err;

    rad_copy(org, hit->p);
    for (int k = 0; k < 3; k++)
        way[k] = (double)hit->way[k];
    cos_i = rad_dot(hit->n, way);
    if (side * cos_i < 0) {
        double most = rad_least(RAD_GEOM_BACK * hit->err, hit->t);
        double back = rad_least(DRAWN_BACK * hit->err / fabs(cos_i), most);

        rad_madd(org, org, -back, way);
        off -= back * fabs(cos_i);
    }
    /* Two bounds: one to be on dir's side wherever the surface really is, one
     * to outweigh the rounding of the new ray's own test against the
     * surface. */
    if (off > 0)
        rad_madd(org, org, copysign(off, side), hit->n);
}
