/* bundle.h - a scene and the files it needs, by their hashes
 *
 * A bundle is what travels to the workers: the frozen octree, and what is read
 * at run time (fonts and texts now), each file stored under the SHA-256 of its
 * bytes.  Its manifest maps the scene's names to hashes.  It is text, so that
 * it can be looked at:
 *
 *     radd-bundle 1
 *     <64 hex digits> <size> scene -
 *     <64 hex digits> <size> file helvet.fnt
 *
 * one line a file, the scene first, then the files by name; fields are parted
 * by one space, and the name is the rest of the line, as the scene has it.  The
 * SHA-256 of the manifest's text names the bundle: equal scenes have equal
 * manifests.  The scene is named "-".
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

/* A file that no scene names: ambient records that a job begins with, as they
 * travel between workers, one after another. */
#define RAD_BUNDLE_RECORDS "ambient records"

/* Another: the frames of a job that has many (proto/message.h). */
#define RAD_BUNDLE_VIEWS "list of frames"

/* Another: the rays of a job of sensor points (points/points.h). */
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

/* Add a file; keeps the order.  Adding the same file twice is one entry; a
 * second content for a name is RAD_EDATA. */
int rad_bundle_add(struct rad_bundle *b, enum rad_bundle_role role,
                   const char *name, const char *hash, uint64_t size,
                   struct rad_error *err);

/* Take one out again; nothing where there is none. */
void rad_bundle_remove(struct rad_bundle *b, enum rad_bundle_role role,
                       const char *name);

/* NULL when there is none; name is ignored for RAD_BUNDLE_SCENE. */
const struct rad_bundle_entry *rad_bundle_find(const struct rad_bundle *b,
                                               enum rad_bundle_role role,
                                               const char *name);

/* Sum of the sizes of its distinct files. */
uint64_t rad_bundle_bytes(const struct rad_bundle *b);

/* The manifest's text, malloc'd, NUL-terminated; NULL: out of memory. */
char *rad_bundle_format(const struct rad_bundle *b, size_t *len);

/* Read a manifest of len bytes into *b (initialised here); RAD_EDATA with the
 * line for anything but what rad_bundle_format() writes. */
int rad_bundle_parse(struct rad_bundle *b, const char *text, size_t len,
                     struct rad_error *err);

/* Where a bundle's files lie: dir/<hash>.  Set both fields, then use
 * rad_bundle_files(); the folder and the bundle must outlive the result.  A
 * file whose length is not the manifest's is RAD_EDATA. */
struct rad_bundle_dir {
    const struct rad_bundle *bundle;
    const char *dir;
};
struct rad_files rad_bundle_files(struct rad_bundle_dir *where);

#endif
