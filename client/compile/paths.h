/* paths.h - where a scene's files are looked for
 *
 * A name that begins with "/" or "~" (a home folder) is a path.  Other names
 * are looked for along RAYPATH, a list of folders separated by colons, as
 * Radiance does (":/usr/local/lib/ray" if RAYPATH is not set).  Where Radiance
 * takes the current folder, which it does for an empty or relative entry and
 * for a name that begins with ".", the folders of the scene's files are tried
 * first.  So a scene means the same wherever it is submitted from.
 * Thread: one. */
#ifndef RADD_CLIENT_PATHS_H
#define RADD_CLIENT_PATHS_H

#include "base/files.h"
#include "common/inputs.h"

#define PATHS_MAX_FILE ((size_t)1 << 30) /* most bytes of a file */

struct paths {
    char **folders; /* of the scene's files, without "." */
    int n;
    char *raypath;
    struct inputs *inputs; /* gets the files that are read; may be NULL */
};

/* Take RAYPATH from the environment. */
int paths_init(struct paths *p, struct rad_error *err);
void paths_release(struct paths *p);

/* Add the folder of a scene file. */
int paths_add_file(struct paths *p, const char *scene_file,
                   struct rad_error *err);

/* The folder of a file, malloc'd, "." if the name has no slash; NULL: memory is
 * out. */
char *paths_folder_of(const char *file);

/* The path of a readable file, malloc'd; NULL with RAD_ENOINPUT, or RAD_ENOMEM
 * if it is there. */
char *paths_find(const struct paths *p, const char *name,
                 struct rad_error *err);

/* Reads files that are found so; p must outlive the result. */
struct rad_files paths_files(struct paths *p);

#endif
