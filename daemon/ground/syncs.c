/* syncs.c - see syncs.h */
#include "config.h"

#include "ground/syncs.h"

#include "ground/disk.h"

#include "base/list.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct syncs_file {
    char *path;
    bool named;
};

int
syncs_add(struct syncs *s, const char *path, bool named, struct rad_error *err)
{
    char *copy = strdup(path);

    if (!copy || !rad_list_grow(&s->file, s->n, sizeof *s->file)) {
        free(copy);
        return rad_fail_memory(err);
    }
    s->file[s->n++] = (struct syncs_file){ copy, named };
    return 0;
}

void
syncs_begin(int fd)
{
    int ignored = sync_file_range(fd, 0, 0, SYNC_FILE_RANGE_WRITE);

    (void)ignored; /* the sync that follows writes all the same */
}

static void
begin_all(const struct syncs *s)
{
    for (size_t i = 0; i < s->n; i++) {
        int fd = open(s->file[i].path, O_RDONLY | O_CLOEXEC);

        if (fd < 0)
            continue;
        syncs_begin(fd);
        close(fd);
    }
}

static int
sync_file(const char *path, struct rad_error *err)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC), rc;

    if (fd < 0)
        return errno == ENOENT ? 0 : disk_fail(err, errno, "open", path);
    rc = disk_sync_data(fd, path, err);
    close(fd);
    return rc;
}

/* Length of the path before its last slash. */
static size_t
dir_of(const char *path)
{
    const char *slash = strrchr(path, '/');

    return slash ? (size_t)(slash - path) : 0;
}

/* Sync the folders of new names, once for names that follow each other in the
 * same folder. */
static int
sync_dirs(const struct syncs *s, struct rad_error *err)
{
    const char *last = NULL;
    int rc = 0;

    for (size_t i = 0; i < s->n && rc == 0; i++) {
        const char *path = s->file[i].path;

        if (!s->file[i].named || access(path, F_OK) < 0 ||
            (last && dir_of(last) == dir_of(path) &&
             memcmp(last, path, dir_of(path)) == 0))
            continue;
        last = path;
        rc = disk_sync_dir_of(path, err);
    }
    return rc;
}

int
syncs_settle(struct syncs *s, struct rad_error *err)
{
    int rc = 0;

    if (s->n > 1)
        begin_all(s);
    for (size_t i = 0; i < s->n && rc == 0; i++)
        rc = sync_file(s->file[i].path, err);
    if (rc == 0)
        rc = sync_dirs(s, err);
    syncs_release(s);
    return rc;
}

void
syncs_release(struct syncs *s)
{
    for (size_t i = 0; i < s->n; i++)
        free(s->file[i].path);
    free(s->file);
    memset(s, 0, sizeof *s);
}
