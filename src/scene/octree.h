/* octree.h - Radiance's octree of a scene's surfaces
 *
 * A cube around the finite surfaces, cut into eight down to 1/16384 of its
 * edge until no more than `leaf` surfaces meet a cube: with RAD_OCTREE_LEAF
 * what oconv builds, for Radiance's programs to trace.  With RAD_OCTREE_MAX_SET
 * it is made in much less time, and they can still read it: enough for a scene
 * on its way to workers, whose rays use the BVH (geom.h).  Two things differ
 * from oconv, and only in scenes that it takes very long for: a cube is not cut
 * where two cuts running have parted nothing (coincident surfaces), and where
 * the whole would need more than some 32 entries per surface, cubes keep more
 * surfaces.
 * A cube may name a surface that just misses it, never the other way round.
 * An instance or a mesh is the cube that its file names, moved; the scene's
 * parts (scene/part.h) have no place of their own.
 * Source: Glassner 1984, Space subdivision for fast ray tracing; the rules of
 * oconv(1), -n 6 -r 16384.
 * Thread: immutable once built. */
#ifndef RAD_GEOM_OCTREE_H
#define RAD_GEOM_OCTREE_H

#include "base/error.h"
#include "scene/scene.h"

#include <stddef.h>
#include <stdint.h>

#define RAD_OCTREE_LEAF    6
#define RAD_OCTREE_DEPTH   14  /* 2^14 = 16384 */
#define RAD_OCTREE_MAX_SET 511 /* surfaces in a cube that Radiance reads */
#define RAD_OCTREE_EMPTY   (-1)

/* A node is RAD_OCTREE_EMPTY; or n >= 0: its kids are kids[n]; or n < -1: its
 * set starts at sets[-n - 2], a count and as many indices of objects,
 * ascending.  Kid k lies in the upper half along axis i if k has bit i. */
struct rad_octree {
    double org[3]; /* lowest corner */
    double size;   /* edge; 0: there are no surfaces */
    int32_t root;
    int32_t (*kids)[8];
    int32_t nkids, max_kids;
    int32_t *sets;
    int32_t nsets, max_sets; /* in int32_t */
    int32_t left_out;        /* surfaces not entered where a cube had
                              * RAD_OCTREE_MAX_SET, summed over cubes */
};

void rad_octree_init(struct rad_octree *t);
void rad_octree_release(struct rad_octree *t);

/* Build; *t is initialised here, and empty on failure (RAD_ENOMEM, RAD_EDATA
 * for coordinates that no cube can hold).  Degenerate surfaces (no area) and
 * sources are in no cube. */
int rad_octree_build(struct rad_octree *t, const struct rad_scene *scene,
                     int leaf, struct rad_error *err);

/* The set of a full node, and its count in *n. */
static inline const int32_t *
rad_octree_set(const struct rad_octree *t, int32_t node, int32_t *n)
{
    const int32_t *set = t->sets + (-node - 2);

    *n = set[0];
    return set + 1;
}

#endif
