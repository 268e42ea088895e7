/* bsdftree.h - scattering as a tensor tree, for reading and looking up
 *
 * The unit square stands for a hemisphere, mapped so that areas are projected
 * solid angles over pi.  A tree of rank 4 has two coordinates for incident
 * light (of the direction that it travels in) and two for outgoing light.  A
 * tree of rank 3 has half the distance of the incident direction from the rim,
 * and the outgoing direction turned so that light always comes from the same
 * azimuth.  A node halves each coordinate, or is a grid of 2^k values along
 * each.
 *
 * Light from one direction meets a slice of the tree.  For sampling we keep,
 * for every incident cell of the finest resolution, running sums over blocks of
 * the outgoing square, along Hilbert's curve: 64 of them, or 1024 for a tree of
 * rank 3, which has few incident cells.
 * Private to bsdftree.c and bsdftreeread.c. */
#ifndef RAD_SCENE_BSDFTREE_H
#define RAD_SCENE_BSDFTREE_H

#include "scene/bsdf/bsdfimpl.h"

#include <stdint.h>

#define MOST_BLOCK_LOG 5 /* log2 of the blocks along a side; rank 3 */
#define BLOCK_LOG      3 /* the same for rank 4 */

struct bsdf_node {
    int lg; /* a grid of 2^lg values along each coordinate; -1: a branch */
    union {
        struct bsdf_node **kid; /* bit i: upper half of coordinate i */
        float *value;           /* the last coordinate varies fastest */
    } u;
};

/* The scattered light of an incident cell, over pi, and the fraction of it that
 * lies before each block along the curve. */
struct bsdf_cell {
    double total;
    uint32_t *before;         /* times 2^32 */
    uint8_t finest, coarsest; /* log2 of 1 / a leaf's width */
};

struct bsdf_slices {
    int res_log, block_log;
    bool reverse; /* in and out are exchanged (reciprocity) */
    struct bsdf_cell *cell;
};

enum { Y, U, V, NCHANNELS };

struct bsdf_tree {
    int rank;
    struct bsdf_node *root[NCHANNELS]; /* U and V NULL: grey */
    int finest;                        /* log2 of 1 / the smallest width */
    double rest[3];                    /* sharp channels; Y in all if grey */
    double rest_y;
    struct bsdf_slices slices;
    struct bsdf_slices reverse; /* for transmission of rank 4 */
};

/* A cell on the way down a tree: a node, or a part of a node's grid. */
struct bsdf_cursor {
    const struct bsdf_node *n;
    int left; /* levels of the grid below it */
    uint32_t at[4];
};

static inline struct bsdf_cursor
rad_tree_start(const struct bsdf_node *root)
{
    return (struct bsdf_cursor){ root, root->lg, { 0 } };
}

static inline bool
rad_tree_at_leaf(const struct bsdf_cursor *c)
{
    return c->left == 0;
}

/* Set *kid to one half of *c along each coordinate.  They do not overlap: a
 * whole copy of what was just stored in parts would have to wait for that. */
static inline void
rad_tree_descend(const struct bsdf_cursor *c, int rank, unsigned bits,
                 struct bsdf_cursor *kid)
{
    if (c->n->lg < 0) {
        *kid = rad_tree_start(c->n->u.kid[bits]);
        return;
    }
    kid->n = c->n;
    kid->left = c->left - 1;
    for (int i = 0; i < rank; i++)
        kid->at[i] = c->at[i] << 1 | (bits >> i & 1);
}

static inline double
rad_tree_leaf_value(const struct bsdf_cursor *c, int rank)
{
    size_t i = 0;

    for (int k = 0; k < rank; k++)
        i = i << c->n->lg | c->at[k];
    return (double)c->n->u.value[i];
}

/* The sharp channels of a value with luminance y at a place. */
void rad_tree_channels(const struct bsdf_tree *t, double y,
                       const double place[4], double c[3]);

/* The part of luminance y above the Lambertian rest. */
static inline double
rad_tree_above_rest(const struct bsdf_tree *t, double y)
{
    return y > t->rest_y ? y - t->rest_y : 0;
}

#endif
