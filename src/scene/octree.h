/* octree.h - Radiance's octree of a scene's surfaces
 *
 * A cube around the finite surfaces is cut into eight parts, and these again,
 * down to 1/16384 of its edge, until at most `leaf` surfaces meet each.  With
 * RAD_OCTREE_LEAF this is what oconv builds, for Radiance's programs to trace.
 * With RAD_OCTREE_MAX_SET building takes much less time, and Radiance's
 * programs can still read the result: for scenes on their way to workers, which
 * use a BVH (geom.h) instead.  Two rules differ from oconv's, and only matter
 * in scenes that oconv takes very long for.  A cube is not cut any more after
 * two cuts in a row that gave several parts all surfaces (coincident ones). And
 * if the tree would need more than some 32 entries per surface, cubes keep more
 * surfaces.  A cube may list a surface that just misses it, but lists all that
 * meet it.  An instance or a mesh counts as the cube that its file names,
 * transformed; the surfaces of the scene's parts (scene/part.h) are not entered
 * themselves.
 * Source: Glassner 1984, Space subdivision for fast ray tracing; the rules of
 * oconv(1), -n 6 -r 16384.
 * Thread: immutable once built. */
#ifndef RAD_SCENE_OCTREE_H
#define RAD_SCENE_OCTREE_H

#include "base/error.h"
#include "scene/scene.h"

#include <stdint.h>

#define RAD_OCTREE_LEAF    6
#define RAD_OCTREE_DEPTH   14  /* 2^14 = 16384 */
#define RAD_OCTREE_MAX_SET 511 /* most surfaces of a cube for Radiance */
#define RAD_OCTREE_EMPTY   (-1)

/* A node is RAD_OCTREE_EMPTY; or n >= 0: its children are kids[n]; or n < -1:
 * its set starts at sets[-n - 2], a count and as many indices of objects,
 * ascending.  Child k lies in the upper half along axis i if k has bit i. */
struct rad_octree {
    double org[3]; /* lowest corner */
    double size;   /* edge; 0: there are no surfaces */
    int32_t root;
    int32_t (*kids)[8];
    int32_t nkids, max_kids;
    int32_t *sets;
    int32_t nsets, max_sets; /* in int32_t */
    int32_t left_out;        /* surfaces left out of cubes that have
                              * RAD_OCTREE_MAX_SET, summed over cubes */
};

void rad_octree_init(struct rad_octree *t);
void rad_octree_release(struct rad_octree *t);

/* Make room for `sets` more int32_t in the sets and `kids` more nodes; false:
 * memory is out. */
bool rad_octree_reserve(struct rad_octree *t, int32_t sets, int32_t kids);

/* Build; *t is initialised here, and is empty on failure (RAD_ENOMEM, or
 * RAD_EDATA for coordinates that are too large).  Degenerate surfaces (without
 * area) and sources are left out. */
int rad_octree_build(struct rad_octree *t, const struct rad_scene *scene,
                     int leaf, struct rad_error *err);

/* The set of a node with surfaces, and its count in *n. */
static inline const int32_t *
rad_octree_set(const struct rad_octree *t, int32_t node, int32_t *n)
{
    const int32_t *set = t->sets + (-node - 2);

    *n = set[0];
    return set + 1;
}

#endif
