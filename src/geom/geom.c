/* geom.c - see geom.h
 *
 * Compiles each surface into a struct rad_prim, builds the tree over them and
 * puts them in its order.
 *
 * The tie rule needs two steps to be free of the order of traversal.  The walk
 * finds the nearest hit, and notes whether any other lay within a narrow
 * window behind it (a bound of ray and distance alone, so it holds whichever
 * was found first).  Only then, which is rare, a second walk offers every hit
 * within the nearest one's own error bound, and the best by rank is kept. */
#include "config.h"

#include "geom/geom.h"

#include "base/arena.h"
#include "base/vec.h"
#include "geom/kernel.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

struct rad_geom {
    const struct rad_scene *scene;
    const struct rad_kernel *kernel;
    struct rad_arena arena;
    struct rad_prim *prims; /* in the tree's order */
    uint32_t nprims;
    uint32_t *prim_of; /* by object; NOPRIM: none */
    struct rad_bvh bvh;
};

#define NOPRIM UINT32_MAX

static const struct rad_kernel *
best_kernel(void)
{
    const struct rad_kernel *const *k = rad_kernels();

    while (!(*k)->usable())
        k++;
    return *k;
}

/* Compile all surfaces, in the scene's order. */
static int
make_prims(struct rad_geom *g, const uint8_t *surf, struct rad_error *err)
{
    for (int32_t i = 0; i < g->scene->nobjects; i++) {
        struct rad_prim *p = &g->prims[g->nprims];
        bool nomem = false;

        if (!rad_prim_make(p, &g->scene->objects[i], &g->arena, &nomem)) {
            if (nomem)
                return rad_fail(err, RAD_ENOMEM, "out of memory");
            continue;
        }
        p->obj = i;
        p->surf = surf[i];
        g->nprims++;
    }
    return 0;
}

/* Put the prims in the tree's order, cycle by cycle; order is used up. */
static void
reorder(struct rad_geom *g, uint32_t *order)
{
    for (uint32_t i = 0; i < g->nprims; i++) {
        struct rad_prim held = g->prims[i];
        uint32_t to = i, from;

        while ((from = order[to]) != i) {
            g->prims[to] = g->prims[from];
            order[to] = to;
            to = from;
        }
        g->prims[to] = held;
        order[to] = to;
    }
    for (int32_t i = 0; i < g->scene->nobjects; i++)
        g->prim_of[i] = NOPRIM;
    for (uint32_t i = 0; i < g->nprims; i++)
        g->prim_of[g->prims[i].obj] = i;
}

static size_t
count_surfaces(const struct rad_scene *scene)
{
    size_t n = 0;

    for (int32_t i = 0; i < scene->nobjects; i++)
        n += rad_prim_has(scene->objects[i].type);
    return n;
}

static int
compile(struct rad_geom *g, const uint8_t *surf, struct rad_error *err)
{
    size_t n = count_surfaces(g->scene) + 1; /* one past, to try in */
    int rc;

    g->prims = malloc(n * sizeof *g->prims);
    g->prim_of = malloc(((size_t)g->scene->nobjects + 1) * sizeof *g->prim_of);
    if (!g->prims || !g->prim_of)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = make_prims(g, surf, err);
    if (rc == 0)
        rc = rad_bvh_build(&g->bvh, g->prims, g->nprims, g->prim_of, err);
    if (rc == 0)
        reorder(g, g->prim_of);
    return rc;
}

struct rad_geom *
rad_geom_new(const struct rad_scene *scene, const uint8_t *surf,
             struct rad_error *err)
{
    struct rad_geom *g = calloc(1, sizeof *g);

    if (!g) {
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    rad_arena_init(&g->arena);
    g->scene = scene;
    g->kernel = best_kernel();
    if (compile(g, surf, err) < 0) {
        rad_geom_free(g);
        return NULL;
    }
    return g;
}

void
rad_geom_free(struct rad_geom *g)
{
    if (!g)
        return;
    rad_bvh_release(&g->bvh);
    rad_arena_release(&g->arena);
    free(g->prims);
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
    rad_copy(lo, g->bvh.lo);
    rad_copy(hi, g->bvh.hi);
}

/* False: the span is no ray (a NaN or an infinity in it). */
static bool
probe_span(struct rad_probe *probe, const struct rad_span *span)
{
    const double *d = span->dir;
    double len = fabs(d[0]) + fabs(d[1]) + fabs(d[2]);

    rad_probe_init(probe, span);
    return (probe->size + len < INFINITY) & (len > 0) &
           (span->tmin < span->tmax);
}

/* Make ready to test prims by themselves.  False: the span is no ray. */
static bool
walk_init(struct rad_walk *w, const struct rad_geom *g,
          const struct rad_span *span)
{
    if (!probe_span(&w->probe, span))
        return false;
    w->bvh = &g->bvh;
    w->prims = g->prims;
    w->tmin = span->tmin;
    w->tmax = span->tmax < DBL_MAX ? span->tmax : DBL_MAX;
    w->cut = w->tmax;
    w->best = INFINITY;
    w->prim = NOPRIM;
    w->tie = false;
    w->skip = RAD_VOID;
    w->veiled = false;
    w->tests = w->nodes = 0;
    return true;
}

/* Make ready to walk. */
static void
walk_aim(struct rad_walk *w)
{
    rad_bvh_ray_init(&w->ray, w->bvh, &w->probe, w->tmin);
}

/* Anything opaque on the way?  Into w->prim. */
static bool
walk_any(struct rad_walk *w, const struct rad_kernel *k)
{
    walk_aim(w);
    return k->any(w);
}

static void
add_counts(struct rad_geom_counts *counts, const struct rad_walk *w)
{
    counts->tests += w->tests;
    counts->nodes += w->nodes;
}

/* Is a the better of two hits in one place?  Radiance's order; then the
 * number, so that there is always one answer. */
static bool
outranks(const struct rad_geom *g, const struct rad_prim *a, bool a_front,
         const struct rad_prim *b, bool b_front)
{
    int32_t amod = g->scene->objects[a->obj].modifier;
    int32_t bmod = g->scene->objects[b->obj].modifier;
    int ka = a->surf & (RAD_SURF_NOMATERIAL | RAD_SURF_TRANSPARENT);
    int kb = b->surf & (RAD_SURF_NOMATERIAL | RAD_SURF_TRANSPARENT);

    if (ka != kb) /* NOMATERIAL is the higher bit and the worse lack */
        return ka < kb;
    if (a_front != b_front)
        return a_front;
    if (amod != bmod)
        return amod > bmod;
    return a->obj > b->obj;
}

struct contest {
    const struct rad_geom *g;
    struct rad_hit *hit; /* of the leader */
    const struct rad_prim *leader;
};

static void
offer(struct rad_walk *w, uint32_t prim, double t)
{
    struct contest *c = w->arg;
    const struct rad_prim *p = &w->prims[prim];
    struct rad_hit hit;

    if (p == c->leader)
        return;
    rad_prim_surface(p, &w->probe, t, &hit);
    if (outranks(c->g, p, rad_dot(hit.n, w->probe.dir) < 0, c->leader,
                 rad_dot(c->hit->n, w->probe.dir) < 0)) {
        c->leader = p;
        *c->hit = hit;
    }
}

/* Choose among what lies within the nearest hit's error bound of it. */
static void
settle_tie(const struct rad_geom *g, struct rad_walk *w, struct rad_hit *hit)
{
    struct contest c = { g, hit, &w->prims[w->prim] };
    double slope = fabs(rad_dot(hit->n, w->probe.dir));
    double reach = fmin(hit->err, w->cut - w->best);

    /* along the ray an error of the surface's place counts 1/cos times; never
     * beyond the window that the walk was sure to see */
    if (reach < (w->cut - w->best) * slope)
        reach /= slope;
    else
        reach = w->cut - w->best;
    w->cut = fmin(nextafter(w->best + reach, INFINITY), w->tmax);
    w->offer = offer;
    w->arg = &c;
    g->kernel->all(w);
}

bool
rad_geom_nearest(const struct rad_geom *g, const struct rad_span *span,
                 struct rad_hit *hit, struct rad_geom_counts *counts)
{
    struct rad_walk w;

    hit->obj = RAD_VOID;
    if (!walk_init(&w, g, span))
        return false;
    walk_aim(&w);
    g->kernel->nearest(&w);
    if (w.prim != NOPRIM) {
        rad_prim_surface(&w.prims[w.prim], &w.probe, w.best, hit);
        if (w.tie)
            settle_tie(g, &w, hit);
    }
    add_counts(counts, &w);
    return hit->obj != RAD_VOID;
}

/* Test the remembered blocker; it counts as a test like any other. */
static bool
still_blocks(const struct rad_geom *g, struct rad_walk *w, int32_t obj)
{
    const struct rad_prim *p;
    double t;

    if (obj < 0 || obj >= g->scene->nobjects || obj == w->skip ||
        g->prim_of[obj] == NOPRIM)
        return false;
    p = &g->prims[g->prim_of[obj]];
    if (!(p->surf & RAD_SURF_OPAQUE))
        return false;
    w->tests++;
    return rad_prim_hit(p, &w->probe, w->tmin, w->cut, &t);
}

enum rad_sight
rad_geom_sight(const struct rad_geom *g, const struct rad_span *span,
               int32_t skip, int32_t *blocker, struct rad_geom_counts *counts)
{
    struct rad_walk w;
    bool blocked;

    if (!walk_init(&w, g, span))
        return RAD_SIGHT_CLEAR;
    w.skip = skip;
    blocked = blocker && still_blocks(g, &w, *blocker);
    if (!blocked && walk_any(&w, g->kernel)) {
        blocked = true;
        if (blocker)
            *blocker = w.prims[w.prim].obj;
    }
    add_counts(counts, &w);
    return blocked    ? RAD_SIGHT_BLOCKED
           : w.veiled ? RAD_SIGHT_VEILED
                      : RAD_SIGHT_CLEAR;
}

bool
rad_geom_occluded(const struct rad_geom *g, const struct rad_span *span,
                  int32_t skip, int32_t *blocker,
                  struct rad_geom_counts *counts)
{
    return rad_geom_sight(g, span, skip, blocker, counts) == RAD_SIGHT_BLOCKED;
}

bool
rad_geom_hit_object(const struct rad_geom *g, int32_t obj,
                    const struct rad_span *span, struct rad_hit *hit,
                    struct rad_geom_counts *counts)
{
    const struct rad_prim *p;
    struct rad_probe probe;
    double t;

    hit->obj = RAD_VOID;
    if (obj < 0 || obj >= g->scene->nobjects || g->prim_of[obj] == NOPRIM ||
        !probe_span(&probe, span))
        return false;
    p = &g->prims[g->prim_of[obj]];
    counts->tests++;
    if (!rad_prim_hit(p, &probe, span->tmin, fmin(span->tmax, DBL_MAX), &t))
        return false;
    rad_prim_surface(p, &probe, t, hit);
    return true;
}

void
rad_geom_leave(const struct rad_hit *hit, const double dir[3], double org[3])
{
    /* Twice: once to be on dir's side wherever the surface really is, once to
     * outweigh the rounding of the test that the new ray makes of it. */
    rad_madd(org, hit->p, copysign(2 * hit->err, rad_dot(hit->n, dir)), hit->n);
}
