/* bvh.h - boxes in boxes, eight at a time (inside geom/ only)
 *
 * A tree whose nodes hold the float bounds of up to eight children; a child is
 * a node or a few consecutive items.  The caller's items are put in the
 * tree's order by the permutation that building returns.
 *
 * Coordinates in the tree are (x - centre) * scale, worked out in double, with
 * scale the power of two that brings the scene to about [-1, 1]: so neither an
 * offset of 1e9 nor a size of 1e-6 costs float's digits.  Bounds are rounded
 * outwards twice over (the second step pays for the rounding in double).
 *
 * A ray is widened, not an epsilon added (Ize 2013, Robust BVH ray traversal):
 * each axis has two origins, one for the plane where the ray enters and one for
 * where it leaves, moved apart by the rounding of double to float; the three
 * roundings of (bound - org) * inv are paid for by a factor on the
 * leaving side.  A direction component that is (nearly) zero has inv held at
 * 2^120, and the origins are at least 2^-60 off, so that no product is NaN and
 * a ray inside the slab or on its face stays in.  Bounds and limits are finite,
 * also those of lanes without a child.
 * Thread: immutable once made. */
#ifndef RAD_GEOM_BVH_H
#define RAD_GEOM_BVH_H

#include "geom/prim.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define RAD_BVH_WIDTH 8
/* where a node's bounds of an axis start, side 0 lo, 1 hi */
#define RAD_BVH_BOUND(axis, side) ((2 * (axis) + (side)) * RAD_BVH_WIDTH)
/* Deeper than RAD_BVH_DEPTH a range is halved by count, so that a stack of
 * RAD_BVH_STACK holds any tree: 11 more levels reach 8^11 > 2^32 items. */
#define RAD_BVH_DEPTH 32
#define RAD_BVH_STACK ((RAD_BVH_DEPTH + 12) * (RAD_BVH_WIDTH - 1) + 1)

/* children, biggest surface first; a lane without a child has lo > hi */
struct rad_bvh_node {
    float bound[6 * RAD_BVH_WIDTH]; /* axis by axis the lo, then the hi */
    uint32_t child[RAD_BVH_WIDTH];  /* node index, or leaf: see below */
};

/* A leaf is RAD_BVH_LEAF | (count - 1) << RAD_BVH_SHIFT | first item. */
#define RAD_BVH_LEAF      0x80000000u
#define RAD_BVH_SHIFT     28
#define RAD_BVH_MAX_ITEMS (1u << RAD_BVH_SHIFT)

static inline uint32_t
rad_bvh_leaf(uint32_t first, uint32_t count)
{
    return RAD_BVH_LEAF | (count - 1) << RAD_BVH_SHIFT | first;
}

static inline uint32_t
rad_bvh_leaf_first(uint32_t leaf)
{
    return leaf & (RAD_BVH_MAX_ITEMS - 1);
}

static inline uint32_t
rad_bvh_leaf_count(uint32_t leaf) /* 1 to 8 */
{
    return (leaf >> RAD_BVH_SHIFT & 7) + 1;
}

struct rad_bvh {
    struct rad_bvh_node *nodes; /* [0] is the root */
    uint32_t nnodes, capacity;
    double centre[3], scale;
    double reach;        /* scale, and what rad_bvh_limit() adds */
    double lo[3], hi[3]; /* of all items, in the scene's coordinates */
};

/* A ray in the tree's coordinates. */
struct rad_bvh_ray {
    float org[2][3]; /* for the bound where it enters, leaves; by axis */
    float inv[3];
    int64_t enter[3], leave[3]; /* by which of a node's bounds: their index */
    float tmin;
};

struct rad_set;    /* place.h */
struct rad_meshed; /* place.h */

/* A hit, and what decides between it and others in its place. */
struct rad_met {
    struct rad_hit hit;
    uint8_t surf;    /* RAD_SURF_ bits */
    int32_t obj;     /* the surface itself, whatever stands for it in hit */
    uint32_t number; /* of a mesh's triangle */
};

/* What one walk through the tree carries (walk.inc). */
struct rad_walk {
    const struct rad_bvh *bvh;
    const struct rad_prim *prims;    /* NULL: the tree is a mesh's */
    const struct rad_meshed *meshed; /* NULL: the tree is none */
    const struct rad_geom *geom;     /* that the whole walk goes through */
    const struct rad_set *set;       /* what the tree is over */
    struct rad_probe probe;
    double tmin, tmax; /* of the span */
    double cut;        /* hits from here on do not matter */
    double best;       /* nearest t so far */
    uint32_t prim;     /* which item that is */
    bool tie;          /* another hit lies within the window behind best */
    int32_t skip;      /* object that does not count */
    bool veiled;       /* something not opaque is on the way */
    bool vague;        /* any: and line lacks it, as it was met in a place */
    /* NULL: not wanted; along: surfaces that are passed; any: all that are not
     * opaque */
    struct rad_line *line;
    /* an instance's own modifier: the bits of what is met become
     * (surf & keep) | give */
    uint8_t keep, give;
    uint64_t tests, nodes;
    /* ties: called with every hit */
    void (*offer)(struct rad_walk *w, const struct rad_met *met);
    void *arg;          /* of offer */
    struct rad_met met; /* the nearest, if prims[prim] is a place */
};

#define RAD_NO_PRIM UINT32_MAX

/* What a tree is built over: n items and their bounds. */
struct rad_bvh_items {
    void (*bounds)(const void *arg, uint32_t i, struct rad_box *box);
    const void *arg;
    uint32_t n;
};

/* Build.  order (of n) gets which item is where: the tree's item i is the
 * caller's order[i].  Returns 0 or RAD_ENOMEM. */
int rad_bvh_build(struct rad_bvh *bvh, const struct rad_bvh_items *items,
                  uint32_t *order, struct rad_error *err);
void rad_bvh_release(struct rad_bvh *bvh);

static inline __attribute__((always_inline)) void
rad_bvh_ray_axis(struct rad_bvh_ray *r, const struct rad_bvh *bvh,
                 const struct rad_probe *probe, int a)
{
    double rcp = probe->rcp[a];
    double x = (probe->org[a] - bvh->centre[a]) * bvh->scale;
    double pad = copysign(fabs(x) * 0x1p-22 + 0x1p-60, rcp);

    r->org[0][a] = (float)(x + pad);
    r->org[1][a] = (float)(x - pad);
    r->enter[a] = RAD_BVH_BOUND(a, rcp < 0);
    r->leave[a] = RAD_BVH_BOUND(a, rcp > 0);
    r->inv[a] = (float)(fabs(rcp) < 0x1p120 ? rcp : copysign(0x1p120, rcp));
}

/* A probe in the tree's coordinates.  (A loop here would stay one.) */
static inline __attribute__((always_inline)) void
rad_bvh_ray_init(struct rad_bvh_ray *r, const struct rad_bvh *bvh,
                 const struct rad_probe *probe, double tmin)
{
    rad_bvh_ray_axis(r, bvh, probe, 0);
    rad_bvh_ray_axis(r, bvh, probe, 1);
    rad_bvh_ray_axis(r, bvh, probe, 2);
    /* 2^-20 outweighs what float rounds, here and in the slab test */
    r->tmin = (float)(tmin * bvh->scale * (1 - 0x1p-20));
}

/* The double t as a float in the tree's coordinates that is not below it, with
 * the rounding of a slab test paid for.  Finite, so that what lies infinitely
 * far (a ray from beyond float's range) is not met. */
static inline float
rad_bvh_limit(const struct rad_bvh *bvh, double t)
{
    return (float)rad_least(t * bvh->reach, FLT_MAX);
}

/* One instruction set's walks; all give the same bits. */
struct rad_kernel {
    const char *name;
    bool (*usable)(void); /* by this processor */
    /* does the ray, of which only probe, tmin and cut are looked at, meet p,
     * which is no place? */
    bool (*one)(const struct rad_walk *w, const struct rad_prim *p, double *t);
    /* the nearest hit into w->best, w->prim, w->tie */
    void (*nearest)(struct rad_walk *w);
    /* the same but for what is passed, which goes into w->line */
    void (*along)(struct rad_walk *w);
    /* the first opaque hit met, into w->prim; false: none */
    bool (*any)(struct rad_walk *w);
    /* all hits before w->cut, to w->offer */
    void (*all)(struct rad_walk *w);
    /* the same through a mesh */
    void (*mesh_nearest)(struct rad_walk *w);
    bool (*mesh_any)(struct rad_walk *w);
    void (*mesh_all)(struct rad_walk *w);
};

#endif
