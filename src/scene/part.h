/* part.h - the files that instances and meshes are copies of
 *
 * An instance names a frozen octree, a mesh a compiled mesh; each such file is
 * a part of the scene, read once however many objects name it.  The objects of
 * parts follow the scene's own in its array, so that whatever walks the array
 * (checks, materials, what is reached) sees them too; what the scene's author
 * wrote are the first rad_scene_own() of them.
 * A mesh's part holds its modifiers, and for each of them that triangles have
 * an object that stands for those triangles: a polygon without area, called
 * RAD_MESH_FACE, with that modifier.
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

#define RAD_MESH_FACE "M-Tri" /* rtrace -os says so, too */

struct rad_mesh;

struct rad_part {
    const char *name;      /* as the scene names it */
    enum rad_otype type;   /* RAD_INSTANCE: an octree; RAD_MESH */
    int32_t first, n;      /* its objects in the scene */
    double org[3], size;   /* the cube that its file says holds it */
    struct rad_mesh *mesh; /* meshfile.h; NULL: no mesh */
    int32_t index;         /* in the scene's parts */
    int32_t depth;         /* of parts within it; 0: there are none */
    bool complete;         /* read to its end, with its parts */
    bool failed;           /* could not be read */
};

/* What an instance or mesh says. */
struct rad_use {
    const struct rad_part *part;
    struct rad_xform move; /* from the part's coordinates */
};

/* Read the files that the scene's instances and meshes name, and theirs, and
 * set `use` of all those objects.  Call it once, when all of the scene has been
 * read, before rad_scene_check().  files gives frozen octrees
 * (NULL: there are no files).
 * `each`, if it is not NULL, is called with every error; *err gets the first,
 * and its code is returned: RAD_ENOINPUT for a missing file, RAD_EDATA for what
 * is wrong in one, a bad transform, a file that holds itself, or too many of
 * them. */
int rad_scene_include(struct rad_scene *s, const struct rad_files *files,
                      void (*each)(void *arg, const struct rad_error *err),
                      void *arg, struct rad_error *err);

/* How many of the scene's objects are not of its parts: the first. */
static inline int32_t
rad_scene_own(const struct rad_scene *s)
{
    return s->nparts ? s->parts[0]->first : s->nobjects;
}

#endif
