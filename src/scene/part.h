/* part.h - the files that instances and meshes are copies of
 *
 * An instance names a frozen octree, a mesh a compiled mesh.  Each such file is
 * a part of the scene, and is read once however many objects name it.  The
 * objects of parts follow the scene's own in its array, so that all code that
 * goes over the array (checks, materials, reachability) includes them; the
 * first rad_scene_own() objects are the scene's own.
 * A mesh's part holds its modifiers.  For each modifier of some of its
 * triangles it also holds an object that stands for these triangles: a polygon
 * without area, called RAD_MESH_FACE, with that modifier.
 * Limits: RAD_MAX_PARTS files, nested RAD_MAX_PART_DEPTH deep.
 * Memory: the scene's.
 * Thread: as the scene.
 * Source: Radiance's reference manual, "Instance", "Mesh". */
#ifndef RAD_SCENE_PART_H
#define RAD_SCENE_PART_H

#include "base/files.h"
#include "base/xform.h"
#include "scene/scene.h"

#define RAD_MAX_PARTS      65536
#define RAD_MAX_PART_DEPTH 64

#define RAD_MESH_FACE "M-Tri" /* the name that rtrace -os prints */

struct rad_mesh;

struct rad_part {
    const char *name;      /* of the file, as in the scene */
    enum rad_otype type;   /* RAD_INSTANCE: an octree; RAD_MESH */
    int32_t first, n;      /* its objects in the scene */
    double org[3], size;   /* the cube around it, by its file */
    struct rad_mesh *mesh; /* meshfile.h; NULL: the part is an octree */
    int32_t index;         /* in the scene's parts */
    int32_t depth;         /* levels of parts within it */
    bool complete;         /* read, with the parts within it */
    bool failed;           /* it could not be read */
};

/* What an instance or mesh is a copy of. */
struct rad_use {
    const struct rad_part *part;
    struct rad_xform move; /* from the part's coordinates to the outer ones */
};

/* Read the files that the scene's instances and meshes name, and those that
 * these name, and set `use` of all such objects.  To be called once, when the
 * whole scene is read, before rad_scene_check().  files provides the bytes;
 * NULL: there are no files.
 * If `each` is not NULL, it is called with every error, and reading goes on;
 * *err gets the first, whose code is returned: RAD_ENOINPUT for a missing file,
 * RAD_EDATA for bad data, a bad transform, a file that includes itself, or a
 * limit above. */
int rad_scene_include(struct rad_scene *s, const struct rad_files *files,
                      void (*each)(void *arg, const struct rad_error *err),
                      void *arg, struct rad_error *err);

/* The number of the scene's own objects, which come before those of parts. */
static inline int32_t
rad_scene_own(const struct rad_scene *s)
{
    return s->nparts ? s->parts[0]->first : s->nobjects;
}

#endif
