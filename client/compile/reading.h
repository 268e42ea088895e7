/* reading.h - a scene's own files: its text, the commands in it, its octree
 *
 * Not the files that its objects name.
 * Thread: one in the whole program, because of the commands. */
#ifndef RADD_CLIENT_READING_H
#define RADD_CLIENT_READING_H

#include "compile/compile.h"

struct reading {
    struct compiled *c; /* gets the objects in its scene, folders in its paths */
    const char *folder; /* of the file that is being read */
    bool told;          /* what ended the reading */
    bool octree;        /* a file is one: after a failure it is in pieces */
    bool within;        /* what an octree names is being read */
    bool beside;        /* it is in the octree's folder */
    /* gets each error, if it is not NULL: */
    void (*each)(void *arg, const struct rad_error *err);
    void *arg;
};

/* A file, "-" for the standard input: an octree if it is `alone`, or text.
 * RAD_ENOINPUT, RAD_EDATA, RAD_EUSAGE; RAD_EPERM for a command that an octree
 * names, unless the user trusts it. */
int reading_file(struct reading *r, const char *file, bool alone,
                 struct rad_error *err);

/* "!command" in place of a file, as oconv(1) takes it. */
int reading_command(struct reading *r, const char *text, struct rad_error *err);

/* A scene file, or "!command", that an octree in r->folder names; arg is a
 * struct reading (scene/octfile.h). */
int reading_named(void *arg, const char *name, struct rad_error *err);

/* A warning of the scene; those that nobody asks for are kept.  arg is a struct
 * reading. */
void reading_warn(void *arg, const struct rad_error *err);

#endif
