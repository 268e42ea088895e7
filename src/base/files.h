/* files.h - where a job's files come from, and reading one whole
 *
 * A scene names the files that it needs at run time.  The provider of a struct
 * rad_files finds them: along RAYPATH (client/compile/paths.h) or in a bundle
 * (scene/file/bundle.h).
 * Streams and sinks carry bytes piece by piece, so that readers and writers of
 * formats need not know where the bytes come from or go.
 * Thread: a struct rad_files as its provider says; streams and sinks are used
 * by one thread at a time.  */
#ifndef RAD_BASE_FILES_H
#define RAD_BASE_FILES_H

#include "base/error.h"

#include <stddef.h>

/* read returns a malloc'd copy of the file, which the caller frees, and its
 * length.  A NUL follows the bytes and is not counted.  NULL with *err set if
 * it fails (RAD_ENOINPUT: no such file).
 * open returns a descriptor of the file instead, which the caller closes, or a
 * negative code with *err set.  NULL: files are read alone. */
struct rad_files {
    unsigned char *(*read)(void *arg, const char *name, size_t *len,
                           struct rad_error *err);
    void *arg;
    int (*open)(void *arg, const char *name, struct rad_error *err);
};

/* Open the file at path to read it: a descriptor, or a code as for reading. */
int rad_file_open(const char *path, struct rad_error *err);

/* Read the whole file at path.  RAD_EDATA: more than max bytes; RAD_ENOINPUT:
 * missing or unreadable; RAD_EIO: the disk fails; RAD_ESHORT: a shortage. */
unsigned char *rad_file_read(const char *path, size_t max, size_t *len,
                             struct rad_error *err);

/* Likewise, from an open descriptor, maybe of a pipe, to the end; `name` is for
 * messages. */
unsigned char *rad_fd_read(int fd, const char *name, size_t max, size_t *len,
                           struct rad_error *err);

/* A source of bytes.  read puts at most n bytes into buf and returns how many,
 * 0 at the end, or a negative code with *err set. */
struct rad_stream {
    long (*read)(void *arg, void *buf, size_t n, struct rad_error *err);
    void *arg;
};

/* A destination of bytes.  write takes all n, or returns a negative code with
 * *err set. */
struct rad_sink {
    int (*write)(void *arg, const void *p, size_t n, struct rad_error *err);
    void *arg;
};

/* A stream from memory, a stream from a descriptor and a sink to a descriptor;
 * `name` is for messages.  The structs must outlive the result. */
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

/* A file of a job that is read piece by piece.  The struct stays in its place
 * until it is closed. */
struct rad_opened {
    struct rad_stream in;
    struct rad_fd fd;
    struct rad_memory_in memory;
    unsigned char *bytes; /* of a provider that cannot open */
};
int rad_files_open(const struct rad_files *files, const char *name,
                   struct rad_opened *o, struct rad_error *err);
void rad_opened_close(struct rad_opened *o);

/* Bytes that grow; zeroed there are none.  The caller frees `bytes`. */
struct rad_memory_out {
    unsigned char *bytes;
    size_t len, size;
};
/* Add n bytes; 0 or RAD_ENOMEM. */
int rad_memory_add(struct rad_memory_out *to, const void *p, size_t n,
                   struct rad_error *err);
/* A sink that adds what it gets; *to is zeroed first. */
struct rad_sink rad_memory_sink(struct rad_memory_out *to);

#endif
