/* compile.h - from scene files to a bundle that can be submitted
 *
 * Reads scene files, runs their commands (command.h), finds the files that they
 * need (paths.h), checks everything, builds the octree and writes the bundle
 * (scene/file/bundle.h).  The client does all this as the user, so a bad scene
 * is found before anything is sent.
 * No sockets; nothing is printed but by the commands.
 * Thread: one in the whole program, because of the commands. */
#ifndef RADD_CLIENT_COMPILE_H
#define RADD_CLIENT_COMPILE_H

#include "scene/octree.h"
#include "compile/paths.h"
#include "scene/file/bundle.h"
#include "scene/scene.h"

struct warnings; /* warning.h */

struct compiled {
    struct rad_scene *scene;
    struct paths paths;        /* folders in which its files are looked for */
    struct frozen *frozen;     /* octrees of instances, frozen here: a list */
    int depth;                 /* nesting of octrees that are being frozen */
    bool commands;             /* run commands of octrees, too */
    struct warnings *warnings; /* NULL: none */
    /* set by compile_octree(): */
    struct rad_octree octree;
    /* set by compile_scene(): */
    struct rad_bundle bundle;
};

/* The files of a scene: one octree, or any number of scene texts, where "-" is
 * the standard input and "!command" the output of a command.  An octree that is
 * not frozen is read from the scene files that it names, which are also looked
 * for in its folder; `!command` lines of those, and of instances' octrees, are
 * refused (RAD_EPERM) unless `commands` is set. */
struct compile_from {
    const char *const *files; /* n of them */
    int n;
    bool commands;
};

/* Read a scene, and the files of its instances and meshes.  On failure *c is
 * empty.
 *   RAD_ENOINPUT  a file is missing, or cannot be read
 *   RAD_EDATA     what is wrong, with file and line */
int compile_parse(struct compiled *c, const struct compile_from *from,
                  struct rad_error *err);

/* Read a scene, as above, and check it.  With `each` all errors that can be
 * found are reported, one by one, and so are warnings (RAD_WARNING); *err gets
 * the first error. RAD_ENOINPUT      a file that an object needs is missing
 *   RAD_EUNSUPPORTED  the renderer lacks a type */
int compile_read(struct compiled *c, const struct compile_from *from,
                 void (*each)(void *arg, const struct rad_error *err),
                 void *arg, struct rad_error *err);

/* Reads files that the scene names, along paths; an octree that is not frozen
 * is frozen.  c must outlive the result. */
struct rad_files compile_files(struct compiled *c);

/* Can the functions, data, pictures, fonts and BSDFs that modifiers name be
 * used?  A worker would find out, too, but without the scene's lines.
 * RAD_EDATA or RAD_ENOINPUT, with file and line of the scene. */
int compile_check(struct compiled *c, struct rad_error *err);

/* Build the octree, with at most `leaf` surfaces in a cube (scene/octree.h). */
int compile_octree(struct compiled *c, int leaf, struct rad_error *err);

/* Add a file, which is not the scene's own, to the bundle and to the folder of
 * compile_scene(). */
int compile_add(struct compiled *c, const char *name, const void *bytes,
                size_t len, const char *dir, struct rad_error *err);

/* Remove such a file from both, if it is there. */
void compile_drop(struct compiled *c, const char *name, const char *dir);

/* The hash of the scene and the files that it needs.  Call after
 * compile_scene() and before compile_add(). */
int compile_name(const struct compiled *c, char hex[RAD_SHA_HEX + 1],
                 struct rad_error *err);

/* The same for a scene without a bundle, after compile_read(). */
int compile_digest(struct compiled *c, char hex[RAD_SHA_HEX + 1],
                   struct rad_error *err);

/* Read and check a scene, and write its bundle: the frozen octree and the files
 * that the scene needs, into the existing folder dir, under their hashes
 * (cargo.h).  The files that were read, on failure as well, are noted in
 * inputs, which may be NULL and must outlive *c. */
int compile_scene(struct compiled *c, const struct compile_from *from,
                  const char *dir, struct inputs *inputs,
                  struct rad_error *err);

void compile_release(struct compiled *c);

#endif
