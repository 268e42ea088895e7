/* place.c - see place.h */
#include "config.h"

#include "geom/place.h"

#include "base/arena.h"
#include "base/vec.h"
#include "geom/kernel.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* --- making --- */

/* Let the transform take in what a mesh's integers i mean:
 * x = org + (i + 2^31 + 1/2) * unit. */
static void
unpack_mesh(struct rad_place *pl, const struct rad_mesh *mesh,
            const struct rad_xform *move)
{
    double unit = mesh->size * 0x1p-32, corner[3];

    for (int i = 0; i < 3; i++) {
        corner[i] = mesh->org[i] + mesh->size * (.5 + 0x1p-33);
        rad_scale(pl->m[i], unit, move->m[i]);
    }
    rad_xform_point(pl->t, move, corner);
    pl->scale = move->scale * unit;
}

static inline void
multiply(double out[3], const double v[3], const double m[3][3])
{
    double x = v[0], y = v[1], z = v[2];

    out[0] = x * m[0][0] + y * m[1][0] + z * m[2][0];
    out[1] = x * m[0][1] + y * m[1][1] + z * m[2][1];
    out[2] = x * m[0][2] + y * m[1][2] + z * m[2][2];
}

/* Make m / scale orthogonal.  It is a rotation or reflection, but for the
 * rounding of the product of transforms that it is.  One step of the iteration
 * toward the nearest orthogonal matrix (Bjorck & Bowie 1971) squares the error.
 * False: it is far from orthogonal. */
static bool
straighten(double m[3][3], double scale)
{
    double q[3][3], g[3][3], r[3];

    for (int i = 0; i < 3; i++)
        rad_scale(q[i], 1 / scale, m[i]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            g[i][j] = (3 * (i == j) - rad_dot(q[i], q[j])) / 2;
            if (!(fabs(g[i][j] - (i == j)) < 1e-4))
                return false;
        }
    for (int i = 0; i < 3; i++) {
        multiply(r, g[i], (const double(*)[3])q);
        rad_scale(m[i], scale, r);
    }
    return true;
}

/* Invert the transform, by cofactors, since m is not orthogonal to the last
 * bit.  m is divided by its scale first, so that nothing leaves the range of
 * double.  False: the result is out of range. */
static bool
invert(struct rad_place *pl)
{
    double m[3][3], c[3][3], det;

    for (int i = 0; i < 3; i++)
        rad_scale(m[i], 1 / pl->scale, pl->m[i]);
    rad_cross(c[0], m[1], m[2]);
    rad_cross(c[1], m[2], m[0]);
    rad_cross(c[2], m[0], m[1]);
    det = rad_dot(m[0], c[0]);
    if (!(fabs(det) > .5 && fabs(det) < 2)) /* it should be 1 or -1 */
        return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            pl->back[i][j] = c[j][i] / det / pl->scale;
    multiply(pl->from, pl->t, pl->back);
    rad_scale(pl->from, -1, pl->from);
    return fabs(pl->from[0]) + fabs(pl->from[1]) + fabs(pl->from[2]) <
           RAD_GEOM_MOST;
}

bool
rad_place_make(struct rad_prim *p, const struct rad_object *o,
               const struct rad_set *set, uint8_t surf, uint32_t number,
               struct rad_arena *arena, bool *nomem)
{
    const struct rad_xform *move = &o->use->move;
    struct rad_place *pl = rad_arena_calloc(arena, 1, sizeof *pl);
    struct rad_box box;
    double big = 0;

    if (!pl) {
        *nomem = true;
        return false;
    }
    memset(p, 0, sizeof *p);
    pl->set = set;
    pl->use = o->use;
    pl->number = number;
    pl->covers = o->modifier != RAD_VOID;
    if (o->use->part->mesh) {
        unpack_mesh(pl, o->use->part->mesh, move);
    } else {
        memcpy(pl->m, move->m, sizeof pl->m);
        rad_copy(pl->t, move->t);
        pl->scale = move->scale;
    }
    pl->size = fabs(pl->t[0]) + fabs(pl->t[1]) + fabs(pl->t[2]);
    p->kind = PRIM_PLACE;
    p->surf = pl->covers ? surf : RAD_SURF_OPAQUE;
    p->place = pl;
    pl->len = 1 / pl->scale;
    if (set->nprims == 0 || !(pl->scale > 0 && pl->size < RAD_GEOM_MOST) ||
        !straighten(pl->m, pl->scale) || !invert(pl))
        return false;
    rad_place_bounds(p, &box);
    for (int i = 0; i < 3; i++)
        big += fmax(fabs(box.lo[i]), fabs(box.hi[i]));
    p->slack =
        nextafterf((float)(4 * RAD_GEOM_ROUND * (big + pl->size)), INFINITY);
    return rad_prim_bounded(p);
}

/* Bounds of the root's boxes, which fit more tightly than one box around
 * all. */
void
rad_place_bounds(const struct rad_prim *p, struct rad_box *box)
{
    const struct rad_place *pl = p->place;
    const struct rad_bvh *bvh = &pl->set->bvh;
    const struct rad_bvh_node *root = &bvh->nodes[0];

    for (int i = 0; i < 3; i++) {
        box->lo[i] = INFINITY;
        box->hi[i] = -INFINITY;
    }
    for (int lane = 0; lane < RAD_BVH_WIDTH; lane++) {
        double mid[3], half[3];

        if (!(root->bound[RAD_BVH_BOUND(0, 0) + lane] <=
              root->bound[RAD_BVH_BOUND(0, 1) + lane]))
            continue;
        for (int a = 0; a < 3; a++) {
            double lo = root->bound[RAD_BVH_BOUND(a, 0) + lane] / bvh->scale;
            double hi = root->bound[RAD_BVH_BOUND(a, 1) + lane] / bvh->scale;

            mid[a] = bvh->centre[a] + (lo + hi) / 2;
            half[a] = (hi - lo) / 2;
        }
        multiply(mid, mid, pl->m);
        for (int i = 0; i < 3; i++) {
            double w = half[0] * fabs(pl->m[0][i]) +
                       half[1] * fabs(pl->m[1][i]) +
                       half[2] * fabs(pl->m[2][i]);

            box->lo[i] = fmin(box->lo[i], mid[i] + pl->t[i] - w);
            box->hi[i] = fmax(box->hi[i], mid[i] + pl->t[i] + w);
        }
    }
}

/* --- walking --- */

void
rad_walk_met(const struct rad_walk *w, uint32_t i, double t,
             struct rad_met *met)
{
    if (w->meshed) {
        rad_meshed_met(w, i, t, met);
        return;
    }
    rad_prim_surface(&w->prims[i], &w->probe, t, &met->hit);
    met->surf = w->prims[i].surf;
    met->obj = met->hit.obj;
    met->number = 0;
}

/* Start a walk `in` the place p: turn w's ray into the coordinates of its set.
 * Returns the factor of distances; 0: the ray is out of range there. */
static double
turn(struct rad_walk *in, const struct rad_walk *w, const struct rad_prim *p)
{
    const struct rad_place *pl = p->place;
    double len = pl->len;
    struct rad_span span;

    rad_walk_start(in, w->geom, pl->set);
    multiply(span.org, w->probe.org, pl->back);
    rad_madd(span.org, span.org, 1, pl->from);
    multiply(span.dir, w->probe.dir, pl->back);
    rad_scale(span.dir, pl->scale, span.dir);
    rad_probe_init(&in->probe, &span);
    in->probe.size += 2 * len * (w->probe.size + pl->size);
    if (!(in->probe.size < INFINITY))
        return 0;
    in->tmin = w->tmin * len;
    in->tmax = w->tmax * len;
    if (!(in->tmax < DBL_MAX))
        in->tmax = DBL_MAX;
    /* with a margin: the exact comparison is made outside */
    in->cut = w->cut * len * (1 + 0x1p-50);
    if (!(in->cut < in->tmax))
        in->cut = in->tmax;
    in->keep = w->keep;
    in->give = w->give;
    if (pl->covers && w->keep) {
        in->keep = 0;
        in->give = p->surf;
    }
    in->veiled = w->veiled;
    return len;
}

static void
count(struct rad_walk *w, const struct rad_walk *in)
{
    w->tests += in->tests;
    w->nodes += in->nodes;
}

/* Carry a hit in a place out of it; t is its distance outside. */
static void
carry(const struct rad_walk *w, const struct rad_prim *p, double t,
      struct rad_met *met)
{
    const struct rad_place *pl = p->place;
    struct rad_hit *hit = &met->hit;
    double there = fabs(hit->p[0]) + fabs(hit->p[1]) + fabs(hit->p[2]);

    multiply(hit->p, hit->p, pl->m);
    rad_madd(hit->p, hit->p, 1, pl->t);
    multiply(hit->n, hit->n, pl->m);
    rad_normalize(hit->n);
    if (hit->bent) {
        multiply(hit->bend, hit->bend, pl->m);
        rad_scale(hit->bend, 1 / pl->scale, hit->bend);
    }
    hit->t = t;
    rad_hit_come(hit, w->probe.dir);
    hit->err = pl->scale * hit->err +
               2 * RAD_GEOM_ROUND *
                   (fabs(hit->p[0]) + fabs(hit->p[1]) + fabs(hit->p[2]) +
                    pl->size + pl->scale * there);
    if (pl->covers || hit->obj == RAD_VOID) {
        hit->obj = p->obj;
        hit->in = NULL;
        if (pl->covers)
            met->surf = p->surf;
    } else {
        hit->copy =
            pl->number + (uint64_t)w->set->nplaces * (hit->in ? hit->copy : 0);
        hit->in = w->geom;
    }
}

/* Find the nearest hit in a place and compare it with the nearest so far, as
 * walk.inc does for other surfaces. */
static void
meet_nearest(struct rad_walk *w, uint32_t i)
{
    const struct rad_prim *p = &w->prims[i];
    struct rad_walk in;
    double len = turn(&in, w, p), t, behind;

    if (len == 0)
        return;
    (in.meshed ? w->geom->kernel->mesh_nearest : w->geom->kernel->nearest)(&in);
    count(w, &in);
    if (in.prim == RAD_NO_PRIM)
        return;
    t = in.best / len;
    if (!(t > w->tmin && t < w->cut))
        return;
    if (t > w->best || (t == w->best && p->obj > w->prims[w->prim].obj)) {
        w->tie = true;
        return;
    }
    behind = t + rad_walk_window(w, t);
    w->tie = in.tie || w->best <= behind;
    w->best = t;
    w->prim = i;
    w->cut = behind < w->tmax ? behind : w->tmax;
    if (in.prims && in.prims[in.prim].kind == PRIM_PLACE)
        w->met = in.met;
    else
        rad_walk_met(&in, in.prim, in.best, &w->met);
    carry(w, p, t, &w->met);
}

static bool
meet_any(struct rad_walk *w, uint32_t i)
{
    struct rad_walk in;
    bool blocked;

    if (turn(&in, w, &w->prims[i]) == 0)
        return false;
    if (w->line) /* find out whether this place holds something */
        in.veiled = false;
    blocked =
        (in.meshed ? w->geom->kernel->mesh_any : w->geom->kernel->any)(&in);
    count(w, &in);
    w->vague |= in.veiled;
    w->veiled |= in.veiled;
    return blocked;
}

/* The walk outside, to which hits in a place are offered. */
struct outside {
    struct rad_walk *w;
    const struct rad_prim *p;
    double len;
};

static void
offer_outside(struct rad_walk *in, const struct rad_met *met)
{
    const struct outside *out = in->arg;
    struct rad_met mine = *met;
    double t = met->hit.t / out->len;

    if (!(t > out->w->tmin && t < out->w->cut))
        return;
    carry(out->w, out->p, t, &mine);
    out->w->offer(out->w, &mine);
}

static void
meet_all(struct rad_walk *w, uint32_t i)
{
    struct outside out = { w, &w->prims[i], 0 };
    struct rad_walk in;

    out.len = turn(&in, w, out.p);
    if (out.len == 0)
        return;
    in.offer = offer_outside;
    in.arg = &out;
    (in.meshed ? w->geom->kernel->mesh_all : w->geom->kernel->all)(&in);
    count(w, &in);
}

bool
rad_place_meet(struct rad_walk *w, uint32_t i, enum rad_meet how)
{
    switch (how) {
    case RAD_MEET_NEAREST:
        meet_nearest(w, i);
        return false;
    case RAD_MEET_ANY:
        return meet_any(w, i);
    default:
        meet_all(w, i);
        return false;
    }
}
