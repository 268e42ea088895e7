/* mark.c - see mark.h */
#include "config.h"

#include "ground/mark.h"

#include "ground/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define READ_BYTES (256u << 10)

int
mark_missing(const char *path, int number, struct rad_error *err)
{
    if (number == ENOENT || number == ENOTDIR)
        return rad_fail(err, RAD_EDATA, "'%s' is missing", path);
    return disk_fail(err, number, "open", path);
}

int
mark_check_size(const struct mark *m, uint64_t size, const char *path,
                struct rad_error *err)
{
    if (m->known && size != m->size)
        return rad_fail(err, RAD_EDATA,
                        "'%s' has %" PRIu64 " bytes, expected %" PRIu64, path,
                        size, m->size);
    if (size == 0)
        return rad_fail(err, RAD_EDATA, "'%s' is empty", path);
    return 0;
}

int
mark_check_sha(const struct mark *m, struct rad_sha *sha, const char *path,
               struct rad_error *err)
{
    char hex[RAD_SHA_HEX + 1], wanted[RAD_SHA_HEX + 1];
    int rc = rad_sha_final(sha, hex, err);

    if (rc < 0)
        return rc;
    rad_sha_to_hex(m->hash, wanted);
    if (m->known && strcmp(hex, wanted) != 0)
        return rad_fail(err, RAD_EDATA, "'%s' is damaged: its hash is another",
                        path);
    return 0;
}

static int
read_all(int fd, struct rad_sha *sha, const char *path, struct rad_error *err)
{
    char *buf = malloc(READ_BYTES);
    ssize_t n;
    int rc = 0;

    if (!buf)
        return rad_fail_memory(err);
    while ((n = read(fd, buf, READ_BYTES)) > 0)
        rad_sha_update(sha, buf, (size_t)n);
    if (n < 0)
        rc = disk_fail(err, errno, "read", path);
    free(buf);
    return rc;
}

static int
check_bytes(const struct mark *m, int fd, const char *path,
            struct rad_error *err)
{
    struct rad_sha sha;
    int rc = rad_sha_init(&sha, err);

    if (rc < 0)
        return rc;
    rc = read_all(fd, &sha, path, err);
    if (rc == 0)
        return mark_check_sha(m, &sha, path, err);
    rad_sha_release(&sha);
    return rc;
}

int
mark_look(const struct mark *m, const char *path, bool whole,
          struct rad_error *err)
{
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC), rc = 0;
    struct stat st;

    if (fd < 0)
        return mark_missing(path, errno, err);
    if (fstat(fd, &st) < 0)
        rc = disk_fail(err, errno, "look at", path);
    else if (!S_ISREG(st.st_mode))
        rc = rad_fail(err, RAD_EDATA, "'%s' is no file", path);
    else
        rc = mark_check_size(m, (uint64_t)st.st_size, path, err);
    if (rc == 0 && whole && m->known)
        rc = check_bytes(m, fd, path, err);
    close(fd);
    return rc;
}
