/* bundle.h - a scene and the files it needs, by their hashes
 *
 * A bundle is what workers get of a scene: the frozen octree and the files that
 * it needs at run time (fonts, function files, data, ...), each stored under
 * the SHA-256 of its bytes.  Its manifest maps the scene's names to hashes, as
 * text, so that people can read it:
 *
 *     radd-bundle 1
 *     <64 hex digits> <size> scene -
 *     <64 hex digits> <size> file helvet.fnt
 *
 * One line for each file: the scene first, then the files by name.  Fields are
 * separated by one space; the name is the rest of the line, as in the scene,
 * and "-" for the scene itself.  The SHA-256 of the manifest's text names the
 * bundle, so equal scenes have equal names.
 * Limits: RAD_MAX_BUNDLE_FILES files, names of 1 to RAD_MAX_BUNDLE_NAME bytes
 * without control characters.
 * Thread: a struct rad_bundle may be read by any number of threads.  */
#ifndef RAD_SCENE_BUNDLE_H
#define RAD_SCENE_BUNDLE_H

#include "base/error.h"
#include "base/files.h"
#include "base/sha.h"

#include <stddef.h>
#include <stdint.h>

#define RAD_MAX_BUNDLE_FILES 65536
#define RAD_MAX_BUNDLE_NAME  4095

/* Files that a job brings along, and that no scene names: */

/* Ambient records that a job begins with, in the format in which they travel
 * between workers, one after another. */
#define RAD_BUNDLE_RECORDS "ambient records"

/* The frames of a job that has many (proto/message.h). */
#define RAD_BUNDLE_VIEWS "list of frames"

/* The rays of a job of sensor points (points/points.h). */
#define RAD_BUNDLE_POINTS "sensor points"

enum rad_bundle_role {
    RAD_BUNDLE_SCENE, /* the frozen octree, exactly one */
    RAD_BUNDLE_FILE,  /* read at run time under its name */
    RAD_BUNDLE_NROLES
};

struct rad_bundle_entry {
    char hash[RAD_SHA_HEX + 1];
    uint64_t size; /* bytes */
    enum rad_bundle_role role;
    char *name; /* owned by the bundle */
};

struct rad_bundle {
    struct rad_bundle_entry *entries; /* sorted by role, then name */
    int n;
};

void rad_bundle_init(struct rad_bundle *b);
void rad_bundle_release(struct rad_bundle *b);

/* Add a file, in order.  Adding a file again changes nothing; other content for
 * the same name is RAD_EDATA. */
int rad_bundle_add(struct rad_bundle *b, enum rad_bundle_role role,
                   const char *name, const char *hash, uint64_t size,
                   struct rad_error *err);

/* Remove a file, if it is there. */
void rad_bundle_remove(struct rad_bundle *b, enum rad_bundle_role role,
                       const char *name);

/* The entry of a file, or NULL; name is ignored for RAD_BUNDLE_SCENE. */
const struct rad_bundle_entry *rad_bundle_find(const struct rad_bundle *b,
                                               enum rad_bundle_role role,
                                               const char *name);

/* The sum of the sizes of all distinct files. */
uint64_t rad_bundle_bytes(const struct rad_bundle *b);

/* The manifest's text, malloc'd and NUL-terminated; NULL: memory is out. */
char *rad_bundle_format(const struct rad_bundle *b, size_t *len);

/* Read a manifest of len bytes into *b, which is initialised here.  RAD_EDATA,
 * with the line, for anything that rad_bundle_format() does not write. */
int rad_bundle_parse(struct rad_bundle *b, const char *text, size_t len,
                     struct rad_error *err);

/* Files of a bundle in a folder, named by their hashes: set both fields, then
 * call rad_bundle_files().  The folder, the bundle and the struct must outlive
 * the result.  A file of another length than in the manifest is RAD_EDATA. */
struct rad_bundle_dir {
    const struct rad_bundle *bundle;
    const char *dir;
};
struct rad_files rad_bundle_files(struct rad_bundle_dir *where);

#endif
