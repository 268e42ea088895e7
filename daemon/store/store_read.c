/* store_read.c - see store_read.h
 *
 * Reads are tasks in the same queue as writes, so a read sees all that was
 * written before it, unless that write is held because the disk is full.  But
 * for previews the file is opened anew for each piece, so no file stays open
 * for a reader that does not come back.  Finished files of a job are hashed as
 * they are read and compared with their marks.  If the disk has spoilt a file
 * its last piece is not sent, so no user takes the file for whole. */
#include "config.h"

#include "store/store_read.h"

#include "store/store_impl.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <unistd.h>

/* Most previews that are read at a time: each has a file open, of the 64
 * descriptors or fewer that connections leave (net/listen.c). */
#define MOST_PREVIEWS 8

struct read_task {
    struct task task;
    struct store_reading *reading;
    void *buf;
    size_t cap, got;
    store_read_fn *fn;
    void *arg;
};

static int
source_path(struct read_task *r, char path[DISK_PATH_MAX])
{
    const struct store_source *from = &r->reading->from;
    struct store *s = store_of(&r->task);
    char part[BLOBS_PATH_MAX];

    if (!from->file)
        return folder_find(&s->folder, from->job, from->frame, from->what,
                           r->reading->offset == 0, path, &r->task.err);
    path_of(s, from->hash, part);
    snprintf(path, DISK_PATH_MAX, "%s", part);
    return 0;
}

static bool
is_preview(const struct store_reading *g)
{
    return g->from.what == MSG_WHAT_PREVIEW;
}

/* Before the first piece: find the mark of the file, if the database has one.
 */
static int
begin(struct read_task *r)
{
    struct store_reading *g = r->reading;
    struct journal *journal = store_of(&r->task)->journal;
    struct rad_error *err = &r->task.err;
    int rc;

    if (g->from.file || is_preview(g) || !journal)
        return 0; /* files of scenes have no mark: workers compare their hash */
    store_reading_release(g); /* the task may run again, after it failed for
                               * want of memory or descriptors */
    rc = journal_find_mark(journal, g->from.job, g->from.frame, g->from.what,
                           &g->mark, err);
    if (rc == 0 && g->mark.known)
        rc = rad_sha_init(&g->sha, err);
    g->hashing = rc == 0 && g->mark.known;
    return rc;
}

/* Add the piece to the hash of the file.  After the last piece that must be the
 * mark's hash. */
static int
hash(struct read_task *r, const char *path)
{
    struct store_reading *g = r->reading;

    if (!g->hashing)
        return 0;
    rad_sha_update(&g->sha, r->buf, r->got);
    if (g->offset + r->got < g->size)
        return 0;
    g->hashing = false;
    return mark_check_sha(&g->mark, &g->sha, path, &r->task.err);
}

static int
read_piece(struct read_task *r, int fd, const char *path)
{
    struct store_reading *g = r->reading;
    struct rad_error *err = &r->task.err;
    struct stat st;
    ssize_t n;
    int rc;

    if (fstat(fd, &st) < 0)
        return disk_fail(err, errno, "look at", path);
    if (g->offset > 0 && (uint64_t)st.st_size != g->size)
        return rad_fail(err, RAD_EDATA, "'%s' changed its size", path);
    g->size = (uint64_t)st.st_size;
    rc = g->mark.known ? mark_check_size(&g->mark, g->size, path, err) : 0;
    if (rc < 0)
        return rc;
    n = pread(fd, r->buf, r->cap, (off_t)g->offset);
    if (n < 0)
        return disk_fail(err, errno, "read", path);
    if (n == 0 && g->offset < g->size)
        return rad_fail(err, RAD_EDATA, "'%s' became shorter", path);
    r->got = (size_t)n;
    return hash(r, path);
}

static int
open_source(const char *path, int *fd, struct rad_error *err)
{
    *fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    return *fd < 0 ? mark_missing(path, errno, err) : 0;
}

/* Open a preview; it stays open for all of its pieces. */
static int
open_preview(struct read_task *r, const char *path)
{
    struct store_reading *g = r->reading;
    struct store *s = store_of(&r->task);
    int rc;

    if (atomic_fetch_add(&s->previews, 1) < MOST_PREVIEWS)
        rc = open_source(path, &g->preview, &r->task.err);
    else
        rc = rad_fail(&r->task.err, RAD_ETEMPFAIL,
                      "%d previews are under way to others", MOST_PREVIEWS);
    if (rc < 0)
        atomic_fetch_sub(&s->previews, 1);
    else
        g->store = s;
    return rc;
}

static int
read_run(struct task *t)
{
    struct read_task *r = (struct read_task *)t;
    struct store_reading *g = r->reading;
    char path[DISK_PATH_MAX] = "the preview";
    int fd, rc = g->store ? 0 : source_path(r, path);

    if (rc == 0 && g->offset == 0)
        rc = begin(r);
    if (rc == 0 && is_preview(g) && !g->store)
        rc = open_preview(r, path);
    if (rc < 0)
        return rc;
    if (g->store)
        return read_piece(r, g->preview, path);
    rc = open_source(path, &fd, &t->err);
    if (rc < 0)
        return rc;
    rc = read_piece(r, fd, path);
    close(fd);
    return rc;
}

/* The status for the user: an error of the coordinator's disk is no error of
 * the user's request. */
static int
status_for_reader(const struct read_task *r)
{
    int code = r->task.code;

    if (r->reading->from.file)
        return EX_NOINPUT;
    return code == RAD_EDATA || code == RAD_EPERM ? EX_IOERR
                                                  : rad_exit_status(code);
}

static void
read_done(struct task *t)
{
    struct read_task *r = (struct read_task *)t;
    char text[sizeof t->err.what + 40];

    if (t->code < 0) {
        snprintf(text, sizeof text, "%s%s",
                 t->code == RAD_EDATA ? "spoilt at the coordinator: " : "",
                 t->err.what);
        r->fn(r->arg, -1, 0, status_for_reader(r), text);
    } else {
        r->reading->offset += r->got;
        r->fn(r->arg, (ssize_t)r->got, r->reading->size, 0, "");
    }
    free(r);
}

void
store_read(struct store *s, struct store_reading *reading, void *buf,
           size_t cap, store_read_fn *fn, void *arg)
{
    struct read_task *r = store_new_task(s, sizeof *r, read_run, read_done);

    r->reading = reading;
    r->buf = buf;
    r->cap = cap;
    r->fn = fn;
    r->arg = arg;
    task_push(&s->queue, &r->task);
}

void
store_reading_release(struct store_reading *r)
{
    if (r->hashing)
        rad_sha_release(&r->sha);
    r->hashing = false;
    if (r->store) {
        close(r->preview);
        atomic_fetch_sub(&r->store->previews, 1);
        r->store = NULL;
    }
}
