/* files.h - where a job's files come from, and reading one whole
 *
 * What a scene needs at run time it names; what lies behind a name is for
 * whoever provides struct rad_files to say: along RAYPATH (client/paths.h), or
 * in a bundle (scene/bundle.h).
 * Thread: as its provider says; those two may be used from one thread at a
 * time.  */
#ifndef RAD_BASE_FILES_H
#define RAD_BASE_FILES_H

#include "base/error.h"

#include <stddef.h>

/* Returns a malloc'd copy of the file that the caller frees and its length,
 * with a NUL behind it that the length does not count; or NULL with *err set
 * (RAD_ENOINPUT: no such file). */
struct rad_files {
    unsigned char *(*read)(void *arg, const char *name, size_t *len,
                           struct rad_error *err);
    void *arg;
};

/* Read the file at path whole, as above.  More than max bytes is RAD_EDATA;
 * a missing or unreadable file RAD_ENOINPUT, a failing read RAD_EIO. */
unsigned char *rad_file_read(const char *path, size_t max, size_t *len,
                             struct rad_error *err);

/* The same from an open descriptor, which may be a pipe, to its end; `name` is
 * for messages. */
unsigned char *rad_fd_read(int fd, const char *name, size_t max, size_t *len,
                           struct rad_error *err);

#endif
