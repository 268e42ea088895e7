/* compile.h - scene files to what is submitted
 *
 * Reads scene files, runs their commands (command.h), finds the files that
 * they need (paths.h), checks everything, builds the octree and writes the
 * bundle (scene/file/bundle.h).  All of it in the client, as the user: a bad
 * scene ends here, before anything is sent.
 * No sockets, and nothing printed but by the commands.
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
    struct paths paths;        /* where its files are found */
    struct frozen *frozen;     /* octrees of instances that were not: a list */
    int depth;                 /* of those being frozen */
    bool commands;             /* those of octrees are run, too */
    struct warnings *warnings; /* NULL: none */
    /* by compile_octree(): */
    struct rad_octree octree;
    /* by compile_scene(): */
    struct rad_bundle bundle;
};

/* Read the scene that is in n files: one octree, or scene text from any number
 * of files, "-" being the standard input, "!command" what a command prints; and
 * the files of its instances and meshes.  An octree that is not frozen is read
 * from the scene files that it names, which are looked for in its folder, too;
 * then, and in octrees of instances, `!command` lines are refused (RAD_EPERM)
 * without `commands`.  With `each` all errors that can be found are told, one
 * by one, and what compile_read() warns of (RAD_WARNING) with them; *err gets
 * the first error.  On failure *c is empty.
 *   RAD_ENOINPUT  a file that is missing, or not readable
 *   RAD_EDATA     what is wrong, with file and line */
int compile_parse(struct compiled *c, const char *const *files, int n,
                  bool commands,
                  void (*each)(void *arg, const struct rad_error *err),
                  void *arg, struct rad_error *err);

/* Read and check it: besides the above,
 *   RAD_ENOINPUT      a file that an object needs is missing
 *   RAD_EUNSUPPORTED  a type that the renderer lacks */
int compile_read(struct compiled *c, const char *const *files, int n,
                 bool commands,
                 void (*each)(void *arg, const struct rad_error *err),
                 void *arg, struct rad_error *err);

/* The files that the scene names, along paths; an octree that is not frozen
 * comes frozen.  c must outlive the result. */
struct rad_files compile_files(struct compiled *c);

/* Is there sense in what the scene's modifiers name: functions, data, pictures,
 * fonts, BSDFs?  A worker would find the same, but knows of no lines.
 * RAD_EDATA or RAD_ENOINPUT, with the scene's file and line. */
int compile_check(struct compiled *c, struct rad_error *err);

/* The octree, with so many surfaces in a cube (scene/octree.h). */
int compile_octree(struct compiled *c, int leaf, struct rad_error *err);

/* Put one more file, that is not the scene's, into the bundle and the folder of
 * compile_scene(). */
int compile_add(struct compiled *c, const char *name, const void *bytes,
                size_t len, const char *dir, struct rad_error *err);

/* Take such a file out of both again, if it is there. */
void compile_drop(struct compiled *c, const char *name, const char *dir);

/* A name for the scene and the files that it needs: equal for equal ones.
 * Needs compile_scene(), and comes before compile_add(). */
int compile_name(const struct compiled *c, char hex[RAD_SHA_HEX + 1],
                 struct rad_error *err);

/* The same where there is no bundle.  Needs compile_read(). */
int compile_digest(struct compiled *c, char hex[RAD_SHA_HEX + 1],
                   struct rad_error *err);

/* Read and check it, and bundle it: the frozen octree and the files that the
 * scene needs are in the folder dir then, which must be there, under their
 * hashes (cargo.h). */
int compile_scene(struct compiled *c, const char *const *files, int n,
                  bool commands, const char *dir, struct rad_error *err);

void compile_release(struct compiled *c);

#endif
