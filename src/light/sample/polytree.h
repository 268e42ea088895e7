/* polytree.h - a polygon as triangles, and triangles in ever larger groups
 *
 * A polygonal light source that is no parallelogram is triangulated once; the
 * triangles are the leaves of a binary tree, and each node has the moments of
 * all triangles below it.  Seen from afar one node stands for the whole, from
 * near by the triangles do.  Polygons may be concave, and have holes that are
 * joined by a seam.
 * Source: Meisters 1975, Polygons have ears.  */
#ifndef RAD_LIGHT_POLYTREE_H
#define RAD_LIGHT_POLYTREE_H

#include "light/sample/sample.h"

/* An edge between two corners of the polygon. */
struct rad_polytree_edge {
    const double *from, *to;
};

struct rad_polytree {
    struct rad_moments m;
    const struct rad_polytree *kid[2]; /* NULL in leaves */
    double p0[3], e1[3], e2[3];        /* of leaves: a corner and two sides */
    /* the outline: the edges that no two triangles below share */
    const struct rad_polytree_edge *edge;
    int nedges;
};

/* Triangulate the polygon of n points v[3 * n] with unit normal, in arena; the
 * tree refers to v.  NULL: out of memory. */
const struct rad_polytree *rad_polytree_new(const double *v, int n,
                                            const double normal[3],
                                            struct rad_arena *arena);

/* Is p, a point of the polygon's plane, inside it? */
bool rad_polytree_has(const struct rad_polytree *t, const double p[3],
                      const double normal[3]);

/* Moments of the triangle with corners p0, p0 + e1, p0 + e2. */
void rad_triangle_moments(struct rad_moments *m, const double p0[3],
                          const double e1[3], const double e2[3]);

#endif
