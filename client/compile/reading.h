/* reading.h - a scene's own files: its text, the commands in it, its octree
 *
 * This does not read the files that objects name.
 * Thread: one in the whole program, because of the commands. */
#ifndef RADD_CLIENT_READING_H
#define RADD_CLIENT_READING_H

#include "compile/compile.h"

struct reading {
    struct compiled *c; /* for its scene and its paths */
    struct inputs *inputs; /* for its paths; may be NULL */
    const char *folder; /* of the file that is being read */
    bool told;          /* the error that ended the reading was reported */
    bool octree;        /* the file is an octree: a failure makes the scene
                         * useless */
    bool within;        /* files that an octree names are being read */
    bool beside;        /* one of these was in the octree's folder */
    struct source *begun; /* a command of the command line that runs already:
                           * the first that the parser begins; or NULL */
    /* gets each error; may be NULL */
    void (*each)(void *arg, const struct rad_error *err);
    void *arg;
};

/* Read a file, "-" for the standard input: an octree, if it is `alone`, or
 * text.  RAD_ENOINPUT, RAD_EDATA, RAD_EUSAGE; RAD_EPERM: an octree names a
 * command that the user has not allowed. */
int reading_file(struct reading *r, const char *file, bool alone,
                 struct rad_error *err);

/* Read the output of "!command", which stands for a file, as with oconv(1) and
 * rpict(1): an octree, if it is `alone`, or text. */
int reading_command(struct reading *r, const char *text, bool alone,
                    struct rad_error *err);

/* Read a scene file or "!command" that an octree in r->folder names; arg is a
 * struct reading (scene/octfile.h). */
int reading_named(void *arg, const char *name, struct rad_error *err);

/* Report a warning to r->each, or keep it.  arg is a struct reading. */
void reading_warn(void *arg, const struct rad_error *err);

#endif
