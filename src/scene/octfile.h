/* octfile.h - Radiance's octree files
 *
 * What Radiance's programs read and write (oconv -f):
 *
 *     text    "#?RADIANCE\n", lines, "FORMAT=Radiance_octree\n", an empty line
 *     u16     283 + w, w the bytes of an object's index (4)
 *     string  four times: lowest corner and edge of the cube, in decimal
 *     string  names of scene files, ending with an empty one; frozen: none.
 *             With any, types and objects are missing: they are theirs
 *     int w   number of objects
 *     tree    u8 0: empty; 1: int w count, as many int w indices of objects;
 *             2: eight trees, the upper half along x, y, z for bits 0, 1, 2
 *     string  names of types, ending with an empty one
 *     objects u8 type's place in that list; int w modifier, -1 none; string
 *             name; u16 count, as many strings; u16 count, as many reals;
 *             ending with type 255
 *
 * Integers are big-endian, in two's complement; strings end with a NUL; a real
 * is an int 4 mantissa m and an int 1 exponent e, (m +- 1/2) / (2^31 - 1) *
 * 2^e, so 31 bits of the 53.
 *
 * What we write goes on behind that, where Radiance's programs look no
 * further: "radd", u8 1, and for each real of each object in order the
 * difference of its bits (IEEE double) from those that the 31 bits give, as
 * signed LEB128 of zigzag.  So a scene read back is the scene that was
 * written, to the last bit.
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

/* Does a file that begins with these bytes say that it is an octree? */
bool rad_octfile_is(const void *start, size_t len);

#define RAD_OCT_NAME 2047 /* bytes of a scene file's name in an octree */

/* Is the octree that begins with these bytes one that names scene files instead
 * of holding their objects?  False also for what is none. */
bool rad_octfile_names(const void *start, size_t len);

/* How to read an octree, and what else is got from it. */
struct rad_octfile {
    struct rad_octree *tree; /* gets its tree; NULL: not wanted, which is much
                              * faster.  None of an octree that is not frozen */
    /* Append the objects of a scene file, or "!command", that an octree names
     * which is not frozen; NULL: refuse those (RAD_EUNSUPPORTED). */
    int (*text)(void *arg, const char *name, struct rad_error *err);
    void *arg;
    double org[3], size; /* get the cube */
};

/* Append the objects of an octree file called `name` to the scene, which must
 * be empty if the tree is wanted (how->tree is initialised here).  RAD_EDATA
 * with the offset ("x.oct: truncated at byte 812"), or for one whose scene
 * files have other objects by now; the scene and the tree are then to be thrown
 * away. */
int rad_octfile_read_as(struct rad_scene *s, struct rad_octfile *how,
                        const struct rad_stream *in, const char *name,
                        struct rad_error *err);

/* The same for one that must be frozen, with its tree or without (NULL). */
int rad_octfile_read(struct rad_scene *s, struct rad_octree *tree,
                     const struct rad_stream *in, const char *name,
                     struct rad_error *err);

/* The scene in the frozen octree file at path, without its tree; NULL and *err
 * on failure (RAD_ENOINPUT: it cannot be opened). */
struct rad_scene *rad_octfile_load(const char *path, struct rad_error *err);

/* What a real is to Radiance's programs once it has been in a frozen octree:
 * the nearest of 31 bits, for whoever must cut it off at the same place. */
double rad_octfile_real(double x);

/* Write the scene's own objects (part.h) and their tree. */
int rad_octfile_write(const struct rad_scene *s, const struct rad_octree *tree,
                      const struct rad_sink *out, struct rad_error *err);

#endif
