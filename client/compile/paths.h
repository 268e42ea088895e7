/* paths.h - where a scene's files are looked for
 *
 * A name that begins with "/" or "~" (a home folder) says where the file is.
 * Others are looked for along RAYPATH (":/usr/local/lib/ray" if it is not
 * set), a list of folders with colons between, as Radiance does.  Where
 * Radiance means the current folder (an empty or relative entry, or a name
 * that begins with "."), the folders of the scene's files come first: a scene
 * means the same wherever it is submitted from.
 * Thread: one. */
#ifndef RADD_CLIENT_PATHS_H
#define RADD_CLIENT_PATHS_H

#include "base/files.h"
#include "common/inputs.h"

#define PATHS_MAX_FILE ((size_t)1 << 30) /* bytes of a file read through it */

struct paths {
    char **folders; /* of the scene's files; "." is not among them */
    int n;
    char *raypath;
    struct inputs inputs; /* files that were read */
};

/* Take RAYPATH from the environment. */
int paths_init(struct paths *p, struct rad_error *err);
void paths_release(struct paths *p);

/* Remember the folder of a scene's file. */
int paths_add_file(struct paths *p, const char *scene_file,
                   struct rad_error *err);

/* The folder of a file: malloc'd, "." for one without a slash; NULL: out of
 * memory. */
char *paths_folder_of(const char *file);

/* The path of a readable file, malloc'd; NULL with RAD_ENOINPUT. */
char *paths_find(const struct paths *p, const char *name,
                 struct rad_error *err);

/* Reading through it; p must outlive the result. */
struct rad_files paths_files(struct paths *p);

#endif
