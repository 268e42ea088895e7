/* octfile.h - Radiance's octree files
 *
 * The format that Radiance's programs read and write (oconv -f):
 *
 *     text    "#?RADIANCE\n", lines, "FORMAT=Radiance_octree\n", an empty line
 *     u16     283 + w, where w is the size of an object's index in bytes (4)
 *     string  four times: lowest corner and edge of the cube, in decimal
 *     string  names of scene files, ending with an empty one.  A frozen octree
 *             has none; one that names files has no types and objects, because
 *             they are in these files
 *     int w   number of objects
 *     tree    u8 0: empty; 1: int w count, as many int w indices of objects;
 *             2: eight trees, those with bits 0, 1, 2 in the upper half along
 *             x, y, z
 *     string  names of types, ending with an empty one
 *     objects u8 type's place in that list; int w modifier, -1 none; string
 *             name; u16 count, as many strings; u16 count, as many reals;
 *             ending with type 255
 *
 * Integers are big-endian, in two's complement; strings end with a NUL; a real
 * is an int 4 mantissa m and an int 1 exponent e, (m +- 1/2) / (2^31 - 1) *
 * 2^e, which keeps 31 of the 53 bits.
 *
 * Our files have more data behind that, which Radiance's programs do not read:
 * "radd", u8 1, and for each real of each object, in order, the difference of
 * its bits (IEEE double) from the bits of the stored real, as signed LEB128 of
 * zigzag.  So a scene that is written and read back is the same, to the last
 * bit.
 *
 * Sources: Radiance's file formats; the header is that of all its files.
 * Thread: any, one at a time for a scene.  */
#ifndef RAD_SCENE_OCTFILE_H
#define RAD_SCENE_OCTFILE_H

#include "base/error.h"
#include "base/files.h"
#include "scene/octree.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

/* Do these first bytes of a file say that it is an octree? */
bool rad_octfile_is(const void *start, size_t len);

#define RAD_OCT_NAME 2047 /* the longest name of a scene file in an octree */

/* Do these first bytes belong to an octree that names scene files instead of
 * holding their objects?  False for other files. */
bool rad_octfile_names(const void *start, size_t len);

/* How to read an octree, and results besides the objects. */
struct rad_octfile {
    struct rad_octree *tree; /* gets the tree, if the octree is frozen; NULL:
                              * not wanted, which is much faster */
    /* Append the objects of a scene file, or "!command", to the scene: called
     * for each that an octree names.  NULL: such octrees are refused
     * (RAD_EUNSUPPORTED). */
    int (*text)(void *arg, const char *name, struct rad_error *err);
    void *arg;
    double org[3], size; /* get the cube */
};

/* Append the objects of an octree file called `name` to the scene.  The scene
 * must be empty if how->tree is set; the tree is initialised here.  RAD_EDATA
 * with the offset ("x.oct: truncated at byte 812"), or if the octree names
 * scene files whose objects have changed.  On failure the caller frees the
 * scene; the tree is released. */
int rad_octfile_read_as(struct rad_scene *s, struct rad_octfile *how,
                        const struct rad_stream *in, const char *name,
                        struct rad_error *err);

/* The same for a frozen octree, with its tree or without (NULL). */
int rad_octfile_read(struct rad_scene *s, struct rad_octree *tree,
                     const struct rad_stream *in, const char *name,
                     struct rad_error *err);

/* Load the scene of the frozen octree file at path, without the tree.  NULL and
 * *err on failure (RAD_ENOINPUT: the file cannot be opened).  Its objects are
 * said to be of "the scene". */
struct rad_scene *rad_octfile_load(const char *path, struct rad_error *err);

/* A real after Radiance's programs have stored it in a frozen octree and read
 * it: cut to 31 bits.  For callers that must round as they do. */
double rad_octfile_real(double x);

/* Write the scene's own objects (part.h) and their tree.  RAD_ENOMEM, or the
 * sink's failure. */
int rad_octfile_write(const struct rad_scene *s, const struct rad_octree *tree,
                      const struct rad_sink *out, struct rad_error *err);

#endif
