/* blobs.c - see blobs.h */
#include "config.h"

#include "base/output.h"
#include "files/blobs.h"

#include "ground/disk.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <time.h>
#include <unistd.h>

static const char part_suffix[] = ".part";

static void
drop_parts(const struct blobs *b)
{
    DIR *d = disk_open_dir(b->dir);
    struct dirent *e;

    if (!d)
        return;
    while ((e = readdir(d)) != NULL) {
        size_t n = strlen(e->d_name), m = sizeof part_suffix - 1;

        if (n > m && strcmp(e->d_name + n - m, part_suffix) == 0)
            unlinkat(dirfd(d), e->d_name, 0);
    }
    closedir(d);
}

int
blobs_open(struct blobs *b, const char *dir, struct rad_error *err)
{
    int rc;

    if (strlen(dir) >= sizeof b->dir)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", dir);
    memcpy(b->dir, dir, strlen(dir) + 1);
    b->parts = 0;
    rc = rad_make_dir(dir, 0700, err);
    if (rc == 0)
        drop_parts(b);
    return rc;
}

void
blobs_path(const struct blobs *b, const char *hash, char path[BLOBS_PATH_MAX])
{
    snprintf(path, BLOBS_PATH_MAX, "%s/%.*s", b->dir, RAD_SHA_HEX, hash);
}

bool
blobs_any(const char *dir)
{
    DIR *d = disk_open_dir(dir);
    struct dirent *e;
    bool any = false;

    if (!d)
        return false;
    while (!any && (e = readdir(d)) != NULL)
        any = rad_sha_valid(e->d_name);
    closedir(d);
    return any;
}

/* Set the file's time of access, which nothing else here needs; a file system
 * that is mounted with noatime keeps a time that is set. */
void
blobs_touch(const struct blobs *b, const char *hash)
{
    const struct timespec times[2] = { { .tv_nsec = UTIME_NOW },
                                       { .tv_nsec = UTIME_OMIT } };
    char path[BLOBS_PATH_MAX];
    int ignored;

    blobs_path(b, hash, path);
    ignored = utimensat(AT_FDCWD, path, times, 0);
    (void)ignored; /* the file is not there */
}

static bool
is_kept(const char *name, const uint8_t *keep, size_t n)
{
    uint8_t digest[RAD_SHA_BYTES];

    rad_sha_from_hex(name, digest);
    return rad_sha_among(keep, n, digest);
}

/* Is this a file that was neither touched nor made in the last age_s seconds?
 * A file that was so in the future, by a clock that was wrong, is so now. */
static bool
is_old(int dir, const char *name, long age_s)
{
    static const struct timespec now[2] = { { .tv_nsec = UTIME_NOW },
                                            { .tv_nsec = UTIME_NOW } };
    struct stat st;
    time_t unused;

    if (fstatat(dir, name, &st, AT_SYMLINK_NOFOLLOW) < 0 ||
        !S_ISREG(st.st_mode))
        return false;
    unused =
        time(NULL) - (st.st_atime > st.st_mtime ? st.st_atime : st.st_mtime);
    if (unused < -age_s)
        utimensat(dir, name, now, AT_SYMLINK_NOFOLLOW);
    return unused > age_s;
}

unsigned
blobs_sweep(const struct blobs *b, const uint8_t *keep, size_t n, long age_s)
{
    DIR *d = disk_open_dir(b->dir);
    unsigned removed = 0;
    struct dirent *e;

    if (!d)
        return 0;
    while ((e = readdir(d)) != NULL)
        if (rad_sha_valid(e->d_name) && !is_kept(e->d_name, keep, n) &&
            is_old(dirfd(d), e->d_name, age_s))
            removed += unlinkat(dirfd(d), e->d_name, 0) == 0;
    closedir(d);
    return removed;
}

int
blobs_each(const struct blobs *b, blobs_fn *fn, void *arg)
{
    DIR *d = disk_open_dir(b->dir);
    struct dirent *e;
    struct stat st;
    int rc = 0;

    while (d && rc == 0 && (e = readdir(d)) != NULL)
        if (rad_sha_valid(e->d_name) &&
            fstatat(dirfd(d), e->d_name, &st, AT_SYMLINK_NOFOLLOW) == 0 &&
            S_ISREG(st.st_mode))
            rc = fn(arg, e->d_name, &st);
    if (d)
        closedir(d);
    return rc;
}

bool
blobs_size(const struct blobs *b, const uint8_t hash[RAD_SHA_BYTES],
           uint64_t *bytes)
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
    struct stat st;

    rad_sha_to_hex(hash, name);
    blobs_path(b, name, path);
    *bytes = 0;
    if (stat(path, &st) < 0 || !S_ISREG(st.st_mode))
        return false;
    *bytes = (uint64_t)st.st_size;
    return true;
}

/* Does the file system tell its size?  Some in user space say 0 blocks. */
static bool
look(const struct blobs *b, struct statvfs *s)
{
    return statvfs(b->dir, s) == 0 && s->f_blocks > 0;
}

uint64_t
blobs_disk_bytes(const struct blobs *b)
{
    struct statvfs s;

    return look(b, &s) ? (uint64_t)s.f_blocks * s.f_frsize : UINT64_MAX;
}

uint64_t
blobs_disk_free(const struct blobs *b)
{
    struct statvfs s;

    return look(b, &s) ? (uint64_t)s.f_bavail * s.f_frsize : UINT64_MAX;
}

int
blobs_probe(const struct blobs *b, uint64_t bytes, struct rad_error *err)
{
    char path[BLOBS_PATH_MAX];
    int fd, got, rc = 0;

    snprintf(path, sizeof path, "%s/probe%s", b->dir, part_suffix);
    fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0 && errno == ENOENT) {
        rc = rad_make_dir(b->dir, 0700, err);
        if (rc < 0)
            return rc;
        fd = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    }
    if (fd < 0)
        return disk_fail(err, errno, "create", path);
    /* a file system may not allocate; callers look at its free room, too */
    do
        got = bytes > 0 ? fallocate(fd, 0, 0, (off_t)bytes) : 0;
    while (got < 0 && errno == EINTR); /* a tmpfs, and any signal */
    if (got < 0 && errno != EOPNOTSUPP && errno != ENOSYS)
        rc = disk_fail(err, errno, "write", b->dir);
    close(fd);
    unlink(path);
    return rc;
}

static void
part_path(const struct blob_part *p, char path[BLOBS_PATH_MAX])
{
    snprintf(path, BLOBS_PATH_MAX, "%s/%u%s", p->blobs->dir, p->serial,
             part_suffix);
}

int
blobs_part_open(struct blob_part *p, struct blobs *b, const char *hash,
                uint64_t total, struct rad_error *err)
{
    int rc;

    memset(p, 0, sizeof *p);
    if (!rad_sha_valid(hash))
        return rad_fail(err, RAD_EPROTO, "bad file hash");
    p->blobs = b;
    p->serial = b->parts++;
    p->total = total;
    memcpy(p->hash, hash, sizeof p->hash);
    rc = rad_sha_init(&p->sha, err);
    if (rc == 0)
        p->state = BLOB_ARRIVING;
    return rc;
}

static int
append(struct blob_part *p, int fd, const void *data, size_t n,
       struct rad_error *err)
{
    int rc = disk_write_at(fd, data, n, (off_t)p->got, p->blobs->dir, err);

    if (rc < 0)
        return rc;
    rad_sha_update(&p->sha, data, n);
    p->got += n;
    return 0;
}

static int
check_hash(struct blob_part *p, struct rad_error *err)
{
    char hex[RAD_SHA_HEX + 1];
    int rc;

    if (p->state != BLOB_ARRIVING)
        return 0;
    rc = rad_sha_final(&p->sha, hex, err);
    p->state = BLOB_HASHED;
    if (rc == 0 && strcmp(hex, p->hash) != 0 && p->total == 0)
        rc = rad_fail(err, RAD_EPROTO,
                      "file %.12s came empty: its sender cannot read it",
                      p->hash);
    else if (rc == 0 && strcmp(hex, p->hash) != 0)
        rc = rad_fail(err, RAD_EPROTO,
                      "file %.12s came with the bytes of %.12s: its sender's "
                      "copy is spoilt",
                      p->hash, hex);
    return rc;
}

/* All bytes are there: check them, and give the file its name.  A file that has
 * the name already may be one that a job needs: it goes only when the new bytes
 * are on the disk. */
static int
name_it(struct blob_part *p, int fd, struct rad_error *err)
{
    char from[BLOBS_PATH_MAX], to[BLOBS_PATH_MAX];
    int rc = check_hash(p, err);

    part_path(p, from);
    blobs_path(p->blobs, p->hash, to);
    if (rc == 0 && access(to, F_OK) == 0)
        rc = disk_sync(fd, from, err);
    if (rc == 0 && rename(from, to) < 0)
        rc = disk_fail(err, errno, "keep", to);
    if (rc == 0)
        p->state = BLOB_CLOSED;
    return rc;
}

/* Are n bytes at that offset the next bytes of the file? */
static int
check_place(const struct blob_part *p, uint64_t offset, size_t n,
            struct rad_error *err)
{
    if (offset == p->got && n <= p->total - p->got)
        return 0;
    return rad_fail(err, RAD_EPROTO,
                    "%zu bytes at %llu do not follow %llu of %llu", n,
                    (unsigned long long)offset, (unsigned long long)p->got,
                    (unsigned long long)p->total);
}

/* Write bytes, and name the file after the last of them.  If a former call had
 * written all bytes and failed to name the file, only name it. */
static int
take(struct blob_part *p, uint64_t offset, const void *data, size_t n,
     struct rad_error *err)
{
    bool again = p->got == p->total && offset + n == p->got;
    int rc = again ? 0 : check_place(p, offset, n, err), fd;
    char path[BLOBS_PATH_MAX];

    if (rc < 0)
        return rc;
    part_path(p, path);
    fd = open(path, O_WRONLY | O_CLOEXEC | (p->got > 0 ? 0 : O_CREAT), 0600);
    if (fd < 0)
        return disk_fail(err, errno, "open", path);
    if (!again)
        rc = append(p, fd, data, n, err);
    if (rc == 0 && p->got == p->total)
        rc = name_it(p, fd, err);
    close(fd);
    return rc;
}

int
blobs_part_write(struct blob_part *p, uint64_t offset, const void *data,
                 size_t n, struct rad_error *err)
{
    int rc = take(p, offset, data, n, err);

    if (rc < 0 && rc != RAD_EFULL && rc != RAD_ESHORT)
        blobs_part_abort(p);
    return rc < 0 ? rc : p->state == BLOB_CLOSED;
}

void
blobs_part_abort(struct blob_part *p)
{
    char path[BLOBS_PATH_MAX];

    if (p->state == BLOB_CLOSED)
        return;
    if (p->state == BLOB_ARRIVING)
        rad_sha_release(&p->sha);
    part_path(p, path);
    unlink(path);
    p->state = BLOB_CLOSED;
}
