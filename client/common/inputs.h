/* inputs.h - the files that a program has read, and so must not overwrite
 *
 * A file is identified by its device and inode, whichever name is used.
 * Thread: one. */
#ifndef RADD_CLIENT_INPUTS_H
#define RADD_CLIENT_INPUTS_H

#include "base/error.h"

#include <stddef.h>
#include <sys/stat.h>

struct input {
    dev_t dev;
    ino_t ino;
    const char *what; /* such as "the view file" */
};

/* Begins zeroed. */
struct inputs {
    struct input *list;
    size_t n;
};

/* Note a file by its name (NULL: none), or by a descriptor.  A missing file, or
 * one that is not regular, is not noted.  what must outlive *in.  in may be
 * NULL.  RAD_ENOMEM. */
int inputs_add(struct inputs *in, const char *what, const char *path,
               struct rad_error *err);
int inputs_add_fd(struct inputs *in, const char *what, int fd,
                  struct rad_error *err);

/* `what` of the file with that name; NULL: it was not noted. */
const char *inputs_find(const struct inputs *in, const char *path);

void inputs_release(struct inputs *in);

#endif
