/* bvh.h - boxes in boxes, eight at a time (inside geom/ only)
 *
 * A tree whose nodes hold the bounds, as floats, of up to eight children.  A
 * child is a node or a leaf: a few consecutive items.  The caller puts its
 * items in the tree's order, by the permutation that building returns.
 *
 * Coordinates in the tree are (x - centre) * scale, computed in double.  scale
 * is the power of two that brings the scene to about [-1, 1], so neither an
 * offset of 1e9 nor a size of 1e-6 costs digits of float.  Bounds are rounded
 * outwards by two steps; the second makes up for the rounding in double.
 *
 * Instead of adding an epsilon, the ray is widened (Ize 2013, Robust BVH ray
 * traversal).  Each axis has two origins, one for the plane where the ray
 * enters and one for the plane where it leaves, moved apart by the rounding of
 * double to float.  A factor on the leaving side makes up for the three
 * roundings of (bound - org) * inv.  If a component of the direction is zero,
 * or nearly, inv is 2^120; the origins are at least 2^-60 away from a bound
 * then, so no product is NaN, and a ray inside the slab or on its face stays
 * inside.  Bounds and limits are finite, even those of lanes without a child.
 * Thread: immutable once made. */
#ifndef RAD_GEOM_BVH_H
#define RAD_GEOM_BVH_H

#include "geom/prim.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define RAD_BVH_WIDTH 8
/* Where the bounds of an axis begin in a node; side 0 is lo, 1 is hi. */
#define RAD_BVH_BOUND(axis, side) ((2 * (axis) + (side)) * RAD_BVH_WIDTH)
/* Ranges below depth RAD_BVH_DEPTH are halved by count, so that a stack of
 * RAD_BVH_STACK is enough for any tree: 11 more levels reach 8^11 > 2^32
 * items. */
#define RAD_BVH_DEPTH 32
#define RAD_BVH_STACK ((RAD_BVH_DEPTH + 12) * (RAD_BVH_WIDTH - 1) + 1)

/* Children by surface area, the largest first; a lane without a child has
 * lo > hi. */
struct rad_bvh_node {
    float bound[6 * RAD_BVH_WIDTH]; /* for each axis all lo, then all hi */
    uint32_t child[RAD_BVH_WIDTH];  /* index of a node, or a leaf: see below */
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
    double reach;        /* scale with the margin of rad_bvh_limit() */
    double lo[3], hi[3]; /* bounds of all items, in the scene's coordinates */
};

/* A ray in the tree's coordinates. */
struct rad_bvh_ray {
    float org[2][3]; /* for the plane where it enters, and leaves; by axis */
    float inv[3];
    int64_t enter[3], leave[3]; /* where in bound[] these planes are */
    float tmin;
};

struct rad_set;    /* place.h */
struct rad_meshed; /* meshed.h */

/* A hit, and what the tie rule needs to know of it. */
struct rad_met {
    struct rad_hit hit;
    uint8_t surf;    /* RAD_SURF_ bits */
    int32_t obj;     /* the surface, even if hit.obj is its instance or mesh */
    uint32_t number; /* of a mesh's triangle */
};

/* The state of a walk through one tree (walk.inc). */
struct rad_walk {
    const struct rad_bvh *bvh;
    const struct rad_prim *prims;    /* NULL: the tree is a mesh's */
    const struct rad_meshed *meshed; /* NULL: the tree is no mesh's */
    const struct rad_geom *geom;     /* the whole scene's */
    const struct rad_set *set;       /* the surfaces in the tree */
    struct rad_probe probe;
    double tmin, tmax; /* of the span */
    double cut;        /* hits at this distance or beyond do not matter */
    double best;       /* distance of the nearest hit so far */
    uint32_t prim;     /* its item */
    bool tie;          /* another hit lies in the window behind the nearest */
    int32_t skip;      /* object to ignore */
    bool veiled;       /* something that is not opaque is in the way */
    bool vague;        /* WALK(any): such a thing is in a place, so it is
                        * missing in line */
    /* NULL: not wanted; WALK(along) notes surfaces that are passed, WALK(any)
     * all that are not opaque */
    struct rad_line *line;
    /* for an instance with a modifier of its own: the bits of a surface in it
     * become (surf & keep) | give */
    uint8_t keep, give;
    uint64_t tests, nodes;
    /* for ties: called with every hit */
    void (*offer)(struct rad_walk *w, const struct rad_met *met);
    void *arg;          /* for offer */
    struct rad_met met; /* the nearest hit, if prims[prim] is a place */
};

#define RAD_NO_PRIM UINT32_MAX

/* The n items to build a tree of, and their bounds. */
struct rad_bvh_items {
    void (*bounds)(const void *arg, uint32_t i, struct rad_box *box);
    const void *arg;
    uint32_t n, rays; /* rays that will be traced; 0: very many */
};

/* Build.  order[n] gets the permutation: the tree's item i is the caller's item
 * order[i].  Returns 0, RAD_ENOMEM, or RAD_EDATA: there are too many items. */
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

/* A probe in the tree's coordinates.  (The compiler would not unroll a
 * loop.) */
static inline __attribute__((always_inline)) void
rad_bvh_ray_init(struct rad_bvh_ray *r, const struct rad_bvh *bvh,
                 const struct rad_probe *probe, double tmin)
{
    rad_bvh_ray_axis(r, bvh, probe, 0);
    rad_bvh_ray_axis(r, bvh, probe, 1);
    rad_bvh_ray_axis(r, bvh, probe, 2);
    /* 2^-20 is more than the rounding to float, here and in the slab test */
    r->tmin = (float)(tmin * bvh->scale * (1 - 0x1p-20));
}

/* The distance t in the tree's coordinates, as a float that is no less, with a
 * margin for the rounding of a slab test.  It is finite, so that bounds at
 * infinity (for a ray from beyond the range of float) are not met. */
static inline float
rad_bvh_limit(const struct rad_bvh *bvh, double t)
{
    return (float)rad_least(t * bvh->reach, FLT_MAX);
}

/* The walks for one instruction set; all kernels give the same bits. */
struct rad_kernel {
    const char *name;
    bool (*usable)(void); /* has this processor the instructions? */
    /* does the ray meet p?  False for a place.  Uses only probe, tmin, cut */
    bool (*one)(const struct rad_walk *w, const struct rad_prim *p,
                double t[2]);
    /* find the nearest hit: w->best, w->prim, w->tie */
    void (*nearest)(struct rad_walk *w);
    /* the same, but surfaces that are passed are noted in w->line */
    void (*along)(struct rad_walk *w);
    /* find any opaque hit: w->prim; false: none */
    bool (*any)(struct rad_walk *w);
    /* offer all hits before w->cut to w->offer */
    void (*all)(struct rad_walk *w);
    /* the same through the tree of a mesh */
    void (*mesh_nearest)(struct rad_walk *w);
    bool (*mesh_any)(struct rad_walk *w);
    void (*mesh_all)(struct rad_walk *w);
};

#endif
