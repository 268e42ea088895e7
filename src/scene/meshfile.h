/* meshfile.h - Radiance's compiled meshes
 *
 * What Radiance's obj2mesh writes:
 *
 *     text    as an octree's (octfile.h), with FORMAT=Radiance_tmesh
 *     u16     319 + w, w the bytes of an index
 *     string  four times: lowest corner and edge of the cube, in decimal
 *     real    four: least and most u, least and most v
 *     tree    as an octree's, over triangles; not looked at here
 *     types, objects   as an octree's: the modifiers of the triangles
 *     int 4   number of patches; each:
 *     u8      1, + 2 with normals, + 4 with coordinates u, v
 *     u16     number of vertices, 1 to 256
 *     int 4   x, y, z of each: its place in the cube, 2^32 to an edge
 *     int 4   normal of each, coded (rad_mesh_normal()), 0: none
 *     int 4   u, v of each: place between least and most, 2^32 from one to the
 *             other, u = 0: none
 *     u16     number of triangles within the patch, up to 512; three u8 each
 *     u16     number of modifiers of these; if it is above 1, a u16 for each
 *             triangle, else one for all; an index, -1: none
 *     u16     number of triangles with one vertex elsewhere, up to 256; each an
 *             int 4 vertex (its patch above bit 8), two u8, a u16 modifier
 *     u16     number of those with two elsewhere; each two int 4, a u8, a u16
 *
 * Vertices are kept as the file holds them, integers: so they are exact, and
 * small.  A vertex lies at org + (xyz + 2^31 + 1/2) * size / 2^32.
 * Source: Radiance's file formats.
 * Thread: any, one at a time for a scene; a mesh is immutable once read. */
#ifndef RAD_SCENE_MESHFILE_H
#define RAD_SCENE_MESHFILE_H

#include "scene/part.h"

#include <stdint.h>

#define RAD_MAX_MESH_TRIANGLES (1u << 28)

struct rad_mesh_tri {
    uint32_t v[3];
    uint32_t face; /* in `faces` */
};

struct rad_mesh {
    double org[3], size;
    double uv0[2], uv1[2]; /* least and most u, v */
    int32_t (*xyz)[3];     /* by vertex, 2^31 less than the file's */
    uint32_t *normals;     /* by vertex, coded; NULL: none has one */
    uint32_t (*uv)[2];     /* NULL: none has any */
    uint32_t nverts;
    struct rad_mesh_tri *tris;
    uint32_t ntris;
    int32_t *faces; /* objects that stand for triangles; [0] is RAD_VOID: those
                     * without a modifier */
    uint32_t nfaces;
};

/* Read a mesh called `name`, append its objects to the scene, and set
 * part->mesh, org and size.  RAD_EDATA with the offset; the scene is then to be
 * thrown away. */
int rad_meshfile_read(struct rad_scene *s, struct rad_part *part,
                      const struct rad_stream *in, const char *name,
                      struct rad_error *err);
void rad_mesh_free(struct rad_mesh *mesh);

/* The unit normal that a code stands for, to about 1e-4. */
void rad_mesh_normal(double n[3], uint32_t code);

#endif
