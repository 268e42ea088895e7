/* disk.c - see disk.h */
#include "config.h"

#include "ground/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int
disk_code(int number)
{
    switch (number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
        return RAD_EFULL;
    case EMFILE:
    case ENFILE:
    case ENOMEM:
        return RAD_ESHORT;
    case EACCES:
    case EPERM:
        return RAD_EPERM;
    default:
        return RAD_EIO;
    }
}

int
disk_fail(struct rad_error *err, int number, const char *verb, const char *path)
{
    return rad_fail(err, disk_code(number), "cannot %s '%s': %s", verb, path,
                    strerror(number));
}

int
disk_write_at(int fd, const void *data, size_t n, off_t at, const char *path,
              struct rad_error *err)
{
    const char *from = data;

    while (n > 0) {
        ssize_t put = pwrite(fd, from, n, at);

        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return disk_fail(err, errno, "write", path);
        from += put;
        at += put;
        n -= (size_t)put;
    }
    return 0;
}

int
disk_read_at(int fd, void *data, size_t n, off_t at, const char *path,
             struct rad_error *err)
{
    char *to = data;

    while (n > 0) {
        ssize_t got = pread(fd, to, n, at);

        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return disk_fail(err, errno, "read", path);
        if (got == 0)
            return rad_fail(err, RAD_EIO, "'%s' is too short", path);
        to += got;
        at += got;
        n -= (size_t)got;
    }
    return 0;
}

int
disk_allocate(int fd, off_t n, const char *path, struct rad_error *err)
{
    int number;

    do
        number = posix_fallocate(fd, 0, n);
    while (number == EINTR);
    return number == 0 ? 0 : disk_fail(err, number, "make room for", path);
}

/* RAD_EIO for any errno: the system may have dropped the bytes that it could
 * not write, so that a later sync succeeds and proves nothing. */
static int
sync_failed(const char *path, struct rad_error *err)
{
    return rad_fail(err, RAD_EIO, "cannot sync '%s': %s", path,
                    strerror(errno));
}

int
disk_sync(int fd, const char *path, struct rad_error *err)
{
    return fsync(fd) < 0 ? sync_failed(path, err) : 0;
}

int
disk_sync_data(int fd, const char *path, struct rad_error *err)
{
    return fdatasync(fd) < 0 ? sync_failed(path, err) : 0;
}

int
disk_sync_path(const char *path, struct rad_error *err)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC), rc;

    if (fd < 0)
        return disk_fail(err, errno, "open", path);
    rc = disk_sync(fd, path, err);
    close(fd);
    return rc;
}

int
disk_sync_dir_of(const char *path, struct rad_error *err)
{
    const char *slash = strrchr(path, '/');
    char dir[DISK_PATH_MAX];
    size_t n = slash ? (size_t)(slash - path) : 0;

    if (n >= sizeof dir)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", path);
    if (n == 0)
        return disk_sync_path(slash ? "/" : ".", err);
    memcpy(dir, path, n);
    dir[n] = '\0';
    return disk_sync_path(dir, err);
}

DIR *
disk_open_dir(const char *path)
{
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC), number;
    DIR *d = fd >= 0 ? fdopendir(fd) : NULL;

    if (!d && fd >= 0) {
        number = errno;
        close(fd);
        errno = number;
    }
    return d;
}

int
disk_make_dir(const char *path, struct rad_error *err)
{
    if (mkdir(path, 0700) < 0 && errno != EEXIST)
        return disk_fail(err, errno, "make folder", path);
    return 0;
}

int
disk_file_open(struct disk_file *w, const char *path, struct mark *mark,
               struct rad_error *err)
{
    int rc;

    w->path = path;
    w->mark = mark;
    if (snprintf(w->tmp, sizeof w->tmp, "%s.tmp", path) >= (int)sizeof w->tmp)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", path);
    w->at = 0;
    w->n = 0;
    rc = mark ? rad_sha_init(&w->sha, err) : 0;
    if (rc < 0)
        return rc;
    w->fd = open(w->tmp, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (w->fd >= 0)
        return 0;
    rc = disk_fail(err, errno, "create", w->tmp);
    if (mark)
        rad_sha_release(&w->sha);
    return rc;
}

static int
flush(struct disk_file *w, struct rad_error *err)
{
    int rc = disk_write_at(w->fd, w->buf, w->n, w->at, w->tmp, err);

    if (rc == 0 && w->mark)
        rad_sha_update(&w->sha, w->buf, w->n);
    w->at += (off_t)w->n;
    w->n = 0;
    return rc;
}

int
disk_file_write(void *arg, const void *data, size_t len, struct rad_error *err)
{
    struct disk_file *w = arg;
    const char *from = data;
    int rc = 0;

    while (len > 0 && rc == 0) {
        size_t n = sizeof w->buf - w->n;

        if (n > len)
            n = len;
        memcpy(w->buf + w->n, from, n);
        w->n += n;
        from += n;
        len -= n;
        if (w->n == sizeof w->buf)
            rc = flush(w, err);
    }
    return rc;
}

static int
finish_mark(struct disk_file *w, int rc, struct rad_error *err)
{
    char hex[RAD_SHA_HEX + 1];

    if (!w->mark)
        return rc;
    if (rc < 0) {
        rad_sha_release(&w->sha);
        return rc;
    }
    rc = rad_sha_final(&w->sha, hex, err);
    if (rc < 0)
        return rc;
    w->mark->known = true;
    w->mark->size = (uint64_t)w->at;
    rad_sha_from_hex(hex, w->mark->hash);
    return 0;
}

int
disk_file_close(struct disk_file *w, int rc, struct rad_error *err)
{
    if (rc == 0)
        rc = flush(w, err);
    rc = finish_mark(w, rc, err);
    close(w->fd);
    if (rc == 0 && rename(w->tmp, w->path) < 0)
        rc = disk_fail(err, errno, "rename to", w->path);
    if (rc < 0)
        unlink(w->tmp);
    return rc;
}
