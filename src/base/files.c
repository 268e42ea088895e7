/* files.c - see files.h */
#include "config.h"

#include "base/files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Room for what stat promises and the probe for the end behind it; a pipe
 * promises nothing. */
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

unsigned char *
rad_file_read(const char *path, size_t max, size_t *len, struct rad_error *err)
{
    unsigned char *buf;
    int fd;

    do
        fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
    while (fd < 0 && errno == EINTR);
    if (fd < 0) {
        rad_fail(err, RAD_ENOINPUT, "cannot open '%s': %s", path,
                 strerror(errno));
        return NULL;
    }
    buf = rad_fd_read(fd, path, max, len, err);
    close(fd);
    return buf;
}
