/* blobs.c - see blobs.h */
#include "config.h"

#include "blobs.h"

#include "disk.h"
#include "service.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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
blobs_open(struct blobs *b, const char *dir, bool durable,
           struct rad_error *err)
{
    int rc;

    if (strlen(dir) >= sizeof b->dir)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", dir);
    memcpy(b->dir, dir, strlen(dir) + 1);
    b->durable = durable;
    b->parts = 0;
    rc = service_make_dir(dir, 0750, err);
    if (rc == 0)
        drop_parts(b);
    return rc;
}

void
blobs_path(const struct blobs *b, const char *hash, char path[BLOBS_PATH_MAX])
{
    snprintf(path, BLOBS_PATH_MAX, "%s/%.*s", b->dir, RAD_SHA_HEX, hash);
}

/* The time at which it was read, which is nobody else's here: a folder that is
 * mounted without keeps what is set. */
void
blobs_touch(const struct blobs *b, const char *hash)
{
    const struct timespec times[2] = { { .tv_nsec = UTIME_NOW },
                                       { .tv_nsec = UTIME_OMIT } };
    char path[BLOBS_PATH_MAX];
    int ignored;

    blobs_path(b, hash, path);
    ignored = utimensat(AT_FDCWD, path, times, 0);
    (void)ignored; /* it is not there */
}

static bool
is_kept(const char *name, const uint8_t *keep, size_t n)
{
    uint8_t digest[RAD_SHA_BYTES];

    rad_sha_from_hex(name, digest);
    return rad_sha_among(keep, n, digest);
}

unsigned
blobs_sweep(const struct blobs *b, const uint8_t *keep, size_t n, time_t before)
{
    DIR *d = disk_open_dir(b->dir);
    unsigned removed = 0;
    struct dirent *e;
    struct stat st;

    if (!d)
        return 0;
    while ((e = readdir(d)) != NULL) {
        if (!rad_sha_valid(e->d_name) || is_kept(e->d_name, keep, n) ||
            fstatat(dirfd(d), e->d_name, &st, AT_SYMLINK_NOFOLLOW) < 0 ||
            !S_ISREG(st.st_mode) || st.st_atime >= before ||
            st.st_mtime >= before)
            continue;
        removed += unlinkat(dirfd(d), e->d_name, 0) == 0;
    }
    closedir(d);
    return removed;
}

static void
part_path(const struct blob_part *p, char path[BLOBS_PATH_MAX])
{
    snprintf(path, BLOBS_PATH_MAX, "%s/%u%s", p->blobs->dir, p->serial,
             part_suffix);
}

int
blob_part_open(struct blob_part *p, struct blobs *b, const char *hash,
               uint64_t total, struct rad_error *err)
{
    char path[BLOBS_PATH_MAX];
    int rc;

    memset(p, 0, sizeof *p);
    if (!rad_sha_valid(hash))
        return rad_fail(err, RAD_EPROTO, "bad file hash");
    p->blobs = b;
    p->serial = b->parts++;
    p->total = total;
    memcpy(p->hash, hash, sizeof p->hash);
    rc = rad_sha_init(&p->sha, err);
    if (rc < 0)
        return rc;
    part_path(p, path);
    p->fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (p->fd < 0) {
        rad_sha_release(&p->sha);
        return disk_fail(err, errno, "create", path);
    }
    p->open = true;
    return 0;
}

static int
append(struct blob_part *p, const void *data, size_t n, struct rad_error *err)
{
    int rc = disk_write_at(p->fd, data, n, (off_t)p->got, p->blobs->dir, err);

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
    int rc = p->hashed ? 0 : rad_sha_final(&p->sha, hex, err);

    if (rc < 0 || p->hashed)
        return rc;
    p->hashed = true;
    if (strcmp(hex, p->hash) != 0)
        return rad_fail(err, RAD_EPROTO, "a file came as %.12s but is %.12s",
                        p->hash, hex);
    return 0;
}

/* All bytes are there: check them, make them last, give them their name. */
static int
finish(struct blob_part *p, struct rad_error *err)
{
    char from[BLOBS_PATH_MAX], to[BLOBS_PATH_MAX];
    int rc = check_hash(p, err);

    part_path(p, from);
    blobs_path(p->blobs, p->hash, to);
    if (rc == 0 && p->blobs->durable)
        rc = disk_sync(p->fd, from, err);
    if (rc == 0 && rename(from, to) < 0)
        rc = disk_fail(err, errno, "keep", to);
    if (rc < 0)
        return rc;
    close(p->fd);
    p->open = false;
    if (p->blobs->durable) /* the name lasts only when the folder does */
        rc = disk_sync_dir(p->blobs->dir, err);
    return rc < 0 ? rc : 1;
}

int
blob_part_write(struct blob_part *p, uint64_t offset, const void *data,
                size_t n, struct rad_error *err)
{
    int rc;

    if (p->got == p->total && offset + n == p->got) /* all but the end */
        rc = 0;
    else if (offset != p->got || n > p->total - p->got)
        rc = rad_fail(err, RAD_EPROTO,
                      "%zu bytes at %llu do not follow %llu of %llu", n,
                      (unsigned long long)offset, (unsigned long long)p->got,
                      (unsigned long long)p->total);
    else
        rc = append(p, data, n, err);
    if (rc == 0 && p->got == p->total)
        rc = finish(p, err);
    if (rc < 0 && rc != RAD_EFULL)
        blob_part_abort(p);
    return rc;
}

void
blob_part_abort(struct blob_part *p)
{
    char path[BLOBS_PATH_MAX];

    if (!p->open)
        return;
    if (!p->hashed)
        rad_sha_release(&p->sha);
    part_path(p, path);
    close(p->fd);
    unlink(path);
    p->open = false;
}
