/* store_read.c - reading back what is in the store, piece by piece
 *
 * A read is a task in the same queue as what writes, so it finds what was asked
 * to be written before it, unless that is held because the disk is full.  The
 * file is opened anew for each piece: nothing stays open for a reader that does
 * not come back. */
#include "config.h"

#include "store_impl.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct read_task {
    struct task task;
    struct store *store;
    struct store_source from;
    uint64_t offset, size;
    void *buf;
    size_t cap, got;
    store_read_fn *fn;
    void *arg;
};

static int
source_path(struct read_task *r, char path[DISK_PATH_MAX])
{
    char part[BLOBS_PATH_MAX];

    if (!r->from.file)
        return folder_find(&r->store->folder, r->from.job, r->from.frame,
                           r->from.what, r->offset == 0, path, &r->task.err);
    path_of(r->store, r->from.hash, part);
    snprintf(path, DISK_PATH_MAX, "%s", part);
    return 0;
}

static int
read_run(struct task *t)
{
    struct read_task *r = (struct read_task *)t;
    char path[DISK_PATH_MAX];
    struct stat st;
    ssize_t n = -1;
    int fd, rc = source_path(r, path);

    if (rc < 0)
        return rc;
    fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return rad_fail(&t->err, RAD_ENOINPUT, "cannot open '%s': %s", path,
                        strerror(errno));
    if (fstat(fd, &st) == 0)
        n = pread(fd, r->buf, r->cap, (off_t)r->offset);
    if (n < 0)
        rc = rad_fail(&t->err, RAD_EIO, "cannot read '%s': %s", path,
                      strerror(errno));
    close(fd);
    r->got = n > 0 ? (size_t)n : 0;
    r->size = (uint64_t)st.st_size;
    return rc;
}

static void
read_done(struct task *t)
{
    struct read_task *r = (struct read_task *)t;

    if (t->code < 0)
        r->fn(r->arg, -1, 0, t->err.what);
    else
        r->fn(r->arg, (ssize_t)r->got, r->size, "");
    free(r);
}

void
store_read(struct store *s, const struct store_source *from, uint64_t offset,
           void *buf, size_t cap, store_read_fn *fn, void *arg)
{
    struct read_task *r = store_new_task(s, sizeof *r, read_run, read_done);

    if (!r)
        return;
    r->store = s;
    r->from = *from;
    r->offset = offset;
    r->buf = buf;
    r->cap = cap;
    r->fn = fn;
    r->arg = arg;
    task_push(&s->queue, &r->task);
}
