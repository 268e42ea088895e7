/* inputs.h - the files that a program has read, which it must not write over
 *
 * A file is known by its device and number, so by any of its names.
 * Thread: one. */
#ifndef RADD_CLIENT_INPUTS_H
#define RADD_CLIENT_INPUTS_H

#include "base/error.h"

#include <stddef.h>
#include <sys/stat.h>

struct input {
    dev_t dev;
    ino_t ino;
    const char *what; /* "the view file" */
};

/* Zeroed, it holds nothing. */
struct inputs {
    struct input *list;
    size_t n;
};

/* Note a file by its name (NULL: none), or by a descriptor; what is missing, or
 * no regular file, is none.  what outlives *in.  RAD_ENOMEM. */
int inputs_add(struct inputs *in, const char *what, const char *path,
               struct rad_error *err);
int inputs_add_fd(struct inputs *in, const char *what, int fd,
                  struct rad_error *err);

/* What the file of that name is; NULL: none of them. */
const char *inputs_find(const struct inputs *in, const char *path);

void inputs_release(struct inputs *in);

#endif
