/* room.c - see room.h */
#include "config.h"

#include "folder/room.h"

#include "ground/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* Room to leave free for the notes of other jobs [bytes]: the smaller of
 * MOST_SPARE and 1/SPARE_SHARE of the disk. */
#define MOST_SPARE  (UINT64_C(64) << 20)
#define SPARE_SHARE 64

struct free_room {
    uint64_t all, left, spare; /* bytes */
};

/* Ask the file system.  False: it does not tell; then a full disk shows when
 * room is made. */
static bool
look(const char *dir, struct free_room *r)
{
    struct statvfs fs;

    if (statvfs(dir, &fs) < 0 || fs.f_blocks == 0)
        return false;
    r->all = (uint64_t)fs.f_blocks * fs.f_frsize;
    r->left = (uint64_t)fs.f_bavail * fs.f_frsize;
    r->spare =
        r->all / SPARE_SHARE < MOST_SPARE ? r->all / SPARE_SHARE : MOST_SPARE;
    return true;
}

int
room_check(const char *dir, uint64_t bytes, const char *what,
           struct rad_error *err)
{
    struct free_room r;

    if (!look(dir, &r))
        return 0;
    if (bytes > r.all)
        return rad_fail(err, RAD_EDATA,
                        "%s need %" PRIu64 " MiB, and the coordinator's "
                        "disk has %" PRIu64 " in all",
                        what, bytes >> 20, r.all >> 20);
    if (r.left < r.spare || bytes > r.left - r.spare)
        return rad_fail(err, RAD_EFULL,
                        "%s need %" PRIu64 " KiB, and the disk has "
                        "%" PRIu64 " left",
                        what, (bytes + r.spare) >> 10, r.left >> 10);
    return 0;
}

bool
room_is_small(const char *dir, uint64_t bytes)
{
    struct free_room r;

    return !look(dir, &r) || bytes <= r.spare;
}

static int
set_size(int fd, uint64_t bytes, const char *path, struct rad_error *err)
{
    struct stat st;

    if (fstat(fd, &st) < 0)
        return disk_fail(err, errno, "look at", path);
    if ((uint64_t)st.st_size > bytes)
        return ftruncate(fd, (off_t)bytes) < 0
                   ? disk_fail(err, errno, "shorten", path)
                   : 0;
    return disk_allocate(fd, (off_t)bytes, path, err);
}

int
room_set(const char *path, uint64_t bytes, struct rad_error *err)
{
    int fd, rc;

    if (bytes == 0)
        return unlink(path) < 0 && errno != ENOENT
                   ? disk_fail(err, errno, "remove", path)
                   : 0;
    fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0)
        return disk_fail(err, errno, "make room for", path);
    rc = set_size(fd, bytes, path, err);
    close(fd);
    return rc;
}

uint64_t
room_size(const char *path)
{
    struct stat st;

    return stat(path, &st) == 0 && S_ISREG(st.st_mode) ? (uint64_t)st.st_size
                                                       : 0;
}
