/* files.h - where a job's files come from, and reading one whole
 *
 * What a scene needs at run time it names; what lies behind a name is for
 * whoever provides struct rad_files to say: along RAYPATH
 * (client/compile/paths.h), or in a bundle (scene/file/bundle.h).
 * Streams and sinks are bytes that come or go piece by piece, so that readers
 * and writers of formats need not know what is behind them.
 * Thread: as its provider says; those here may be used from one thread at a
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

/* Bytes from somewhere.  read returns how many it put into buf (at most n, 0
 * at the end) or a negative code with *err set. */
struct rad_stream {
    long (*read)(void *arg, void *buf, size_t n, struct rad_error *err);
    void *arg;
};

/* Bytes to somewhere.  write takes all n or fails with a negative code. */
struct rad_sink {
    int (*write)(void *arg, const void *p, size_t n, struct rad_error *err);
    void *arg;
};

/* A stream from memory, and one from a descriptor, and a sink to one; `name`
 * is for messages.  The structs must outlive the result. */
struct rad_memory_in {
    const void *p;
    size_t left;
};
struct rad_fd {
    int fd;
    const char *name;
};
struct rad_stream rad_memory_stream(struct rad_memory_in *from);
struct rad_stream rad_fd_stream(struct rad_fd *from);
struct rad_sink rad_fd_sink(struct rad_fd *to);

/* A sink that keeps all in memory; free(bytes) when done with it. */
struct rad_memory_out {
    unsigned char *bytes;
    size_t len, size;
};
struct rad_sink rad_memory_sink(struct rad_memory_out *to);

#endif
