/* files.c - see files.h */
#include "config.h"

#include "base/files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The first size of a buffer: the file's size by stat and a byte more, which
 * the read that finds the end needs.  A pipe has no size. */
static size_t
first_size(int fd, size_t max)
{
    struct stat st;
    size_t size = 64 * 1024;

    if (fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0 &&
        (size_t)st.st_size <= max)
        size = (size_t)st.st_size + 1;
    return size;
}

unsigned char *
rad_fd_read(int fd, const char *name, size_t max, size_t *len,
            struct rad_error *err)
{
    size_t size = first_size(fd, max), used = 0;
    unsigned char *buf = malloc(size + 1), *more;

    while (buf) {
        ssize_t n = read(fd, buf + used, size - used);

        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            rad_fail(err, errno == EISDIR ? RAD_ENOINPUT : RAD_EIO,
                     "cannot read '%s': %s", name, strerror(errno));
            goto fail;
        }
        used += (size_t)n;
        if (used > max) {
            rad_fail(err, RAD_EDATA, "'%s' is larger than %zu bytes", name,
                     max);
            goto fail;
        }
        if (n == 0) {
            buf[used] = '\0';
            *len = used;
            return buf;
        }
        if (used == size) {
            size *= 2;
            more = realloc(buf, size + 1);
            if (!more)
                break;
            buf = more;
        }
    }
    rad_fail(err, RAD_ENOMEM, "out of memory reading '%s'", name);
fail:
    free(buf);
    return NULL;
}

/* The code for a file that is not opened: the fault may lie with the disk, or a
 * shortage, and the file be sound. */
static int
open_code(int number)
{
    switch (number) {
    case EIO:
        return RAD_EIO;
    case EMFILE:
    case ENFILE:
    case ENOMEM:
        return RAD_ESHORT;
    default:
        return RAD_ENOINPUT;
    }
}

int
rad_file_open(const char *path, struct rad_error *err)
{
    int fd;

    do
        fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    while (fd < 0 && errno == EINTR);
    return fd >= 0 ? fd
                   : rad_fail(err, open_code(errno), "cannot open '%s': %s",
                              path, strerror(errno));
}

unsigned char *
rad_file_read(const char *path, size_t max, size_t *len, struct rad_error *err)
{
    int fd = rad_file_open(path, err);
    unsigned char *buf;

    if (fd < 0)
        return NULL;
    buf = rad_fd_read(fd, path, max, len, err);
    close(fd);
    return buf;
}

static long
read_memory(void *arg, void *buf, size_t n, struct rad_error *err)
{
    struct rad_memory_in *from = arg;

    (void)err;
    if (n > from->left)
        n = from->left;
    if (n) {
        memcpy(buf, from->p, n);
        from->p = (const char *)from->p + n;
    }
    from->left -= n;
    return (long)n;
}

struct rad_stream
rad_memory_stream(struct rad_memory_in *from)
{
    struct rad_stream in = { read_memory, from };

    return in;
}

static long
read_fd(void *arg, void *buf, size_t n, struct rad_error *err)
{
    const struct rad_fd *from = arg;
    ssize_t got;

    do
        got = read(from->fd, buf, n);
    while (got < 0 && errno == EINTR);
    if (got < 0)
        return rad_fail(err, errno == EISDIR ? RAD_ENOINPUT : RAD_EIO,
                        "cannot read '%s': %s", from->name, strerror(errno));
    return (long)got;
}

struct rad_stream
rad_fd_stream(struct rad_fd *from)
{
    struct rad_stream in = { read_fd, from };

    return in;
}

int
rad_files_open(const struct rad_files *files, const char *name,
               struct rad_opened *o, struct rad_error *err)
{
    int rc;

    o->bytes = NULL;
    o->fd = (struct rad_fd){ -1, name };
    if (files->open) {
        rc = files->open(files->arg, name, err);
        if (rc < 0)
            return rc;
        o->fd.fd = rc;
        o->in = rad_fd_stream(&o->fd);
        return 0;
    }
    o->bytes = files->read(files->arg, name, &o->memory.left, err);
    if (!o->bytes)
        return RAD_ENOINPUT;
    o->memory.p = o->bytes;
    o->in = rad_memory_stream(&o->memory);
    return 0;
}

void
rad_opened_close(struct rad_opened *o)
{
    if (o->fd.fd >= 0)
        close(o->fd.fd);
    free(o->bytes);
}

static int
write_fd(void *arg, const void *p, size_t n, struct rad_error *err)
{
    const struct rad_fd *to = arg;
    const char *next = p;

    while (n > 0) {
        ssize_t put = write(to->fd, next, n);

        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return rad_fail(err, RAD_EIO, "cannot write '%s': %s", to->name,
                            strerror(errno));
        next += put;
        n -= (size_t)put;
    }
    return 0;
}

struct rad_sink
rad_fd_sink(struct rad_fd *to)
{
    struct rad_sink out = { write_fd, to };

    return out;
}

int
rad_memory_add(struct rad_memory_out *to, const void *p, size_t n,
               struct rad_error *err)
{
    if (n > to->size - to->len) {
        size_t size = 2 * to->size + n;
        unsigned char *more = realloc(to->bytes, size);

        if (!more)
            return rad_fail_memory(err);
        to->bytes = more;
        to->size = size;
    }
    if (n)
        memcpy(to->bytes + to->len, p, n);
    to->len += n;
    return 0;
}

static int
write_memory(void *arg, const void *p, size_t n, struct rad_error *err)
{
    return rad_memory_add(arg, p, n, err);
}

struct rad_sink
rad_memory_sink(struct rad_memory_out *to)
{
    struct rad_sink out = { write_memory, to };

    memset(to, 0, sizeof *to);
    return out;
}
