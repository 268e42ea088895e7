/* meshfile.h - Radiance's compiled meshes
 *
 * The format that Radiance's obj2mesh writes:
 *
 *     text    as an octree's (octfile.h), with FORMAT=Radiance_tmesh
 *     u16     319 + w, where w is the size of an index in bytes
 *     string  four times: lowest corner and edge of the cube, in decimal
 *     real    four: least and most u, least and most v
 *     tree    as an octree's, over triangles; skipped here
 *     types, objects   as an octree's: the modifiers of the triangles
 *     int 4   number of patches; each:
 *     u8      1, + 2 with normals, + 4 with coordinates u, v
 *     u16     number of vertices, 1 to 256
 *     int 4   x, y, z of each: position in the cube, of 2^32 steps to an edge
 *     int 4   normal of each, coded (rad_mesh_normal()), 0: none
 *     int 4   u, v of each: position between least and most, in 2^32 steps;
 *             u = 0: none
 *     u16     number of triangles within the patch, up to 512; three u8 each
 *     u16     number of modifiers of these triangles: if above 1, a u16 for
 *             each triangle, else one for all; an index, or -1: none
 *     u16     number of triangles with one vertex in another patch, up to 256;
 *             each an int 4 vertex (its patch above bit 8), two u8, a u16
 *             modifier
 *     u16     number of those with two such vertices; each two int 4, a u8, a
 *             u16
 *
 * Vertices are kept as the integers of the file, which is exact and small.  A
 * vertex lies at org + (xyz + 2^31 + 1/2) * size / 2^32.
 * Source: Radiance's file formats.
 * Thread: any, one at a time for a scene; a mesh is immutable once read. */
#ifndef RAD_SCENE_MESHFILE_H
#define RAD_SCENE_MESHFILE_H

#include "scene/part.h"

#include <stdint.h>

#define RAD_MAX_MESH_TRIANGLES (1u << 28)

struct rad_mesh_tri {
    uint32_t v[3];
    uint32_t face; /* index in `faces` */
};

struct rad_mesh {
    double org[3], size;
    double uv0[2], uv1[2]; /* least and most u, v */
    int32_t (*xyz)[3];     /* by vertex: the file's numbers less 2^31 */
    uint32_t *normals;     /* by vertex, coded; NULL: no vertex has one */
    uint32_t (*uv)[2];     /* by vertex; NULL: no vertex has any */
    uint32_t nverts;
    struct rad_mesh_tri *tris;
    uint32_t ntris;
    int32_t *faces; /* objects that stand for triangles (part.h), by modifier;
                     * [0] is RAD_VOID, for triangles without a modifier */
    uint32_t nfaces;
};

/* Read a mesh called `name`, append its objects to the scene, and set
 * part->mesh, org and size.  RAD_ENOMEM, or RAD_EDATA with the offset; the
 * caller then frees the scene. */
int rad_meshfile_read(struct rad_scene *s, struct rad_part *part,
                      const struct rad_stream *in, const char *name,
                      struct rad_error *err);
void rad_mesh_free(struct rad_mesh *mesh);

/* Decode a unit normal, to about 1e-4. */
void rad_mesh_normal(double n[3], uint32_t code);

#endif
