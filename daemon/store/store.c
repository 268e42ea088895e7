/* store.c - see store.h
 *
 * Each request is a task that owns copies of all it needs.  Arriving files, job
 * folders and the journal belong to the pool thread; the loop does not touch
 * them after store_recover().
 *
 * A file is on the disk, its bytes and its name, before the journal notes it,
 * or its sender hears of it; also a file that a process left which was killed.
 * A file is removed after the journal has noted that it goes.  The folder of a
 * forgotten job is removed before, so the journal may still list the job for a
 * moment, even as one that is not over; and so are, on a full disk, rows of a
 * job that was cancelled.  Names tell the next life of either (folder.h). */
#include "config.h"

#include "base/output.h"
#include "store/store_impl.h"

#include "journal/statedir.h"
#include "net/log.h"
#include "ground/service.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int
store_refuse(const struct store *s, const struct rad_error *why,
             struct rad_error *err)
{
    if (why->code == RAD_EDATA || why->code == RAD_ENOINPUT)
        rad_fail(err, RAD_EDATA, "%.230s; 'radctl check' tells more",
                 why->what);
    else
        *err = *why;
    if (err->code == RAD_EDATA)
        rad_error_where(err, "state folder '%.200s' is damaged", s->dir);
    else if (why->code == RAD_EIO || why->code == RAD_EPERM)
        rad_error_where(err, "state folder '%.200s'", s->dir);
    return err->code;
}

/* --- begin and end --- */

/* Sync all files of rows that a group of tasks wrote, one fdatasync each; then
 * commit their notes, all at once. */
static int
settle(void *arg, struct rad_error *err)
{
    struct store *s = arg;
    int rc;

    if (!s->durable)
        return 0;
    rc = folder_sync(&s->folder, err);
    if (rc == 0 && s->journal)
        rc = journal_commit(s->journal, err);
    if (rc < 0 && s->journal)
        journal_rollback(s->journal);
    if (rc == RAD_EFULL)
        rc = store_shorten_log(s, rc, err);
    return rc;
}

/* Tell the handler of a full disk, for an administrator has to act; a shortage
 * of memory or descriptors passes by itself. */
static void
on_lack(void *arg, enum task_lack what, const char *text)
{
    struct store *s = arg;
    bool full = what == TASK_LACKS_ROOM;

    if (what == TASK_LACKS_MEANS)
        log_warn("work waits why=%s", text);
    else if (!s->full && !full)
        log_info("work goes on");
    if (full && !s->full)
        store_make_room(s);
    if (full != s->full)
        s->handler->fullness(s->arg, full, text);
    s->full = full;
}

static void
on_broken(void *arg, const struct rad_error *err)
{
    struct store *s = arg;

    s->handler->broken(s->arg, rad_exit_status(err->code), err->what);
}

/* A store with a journal has promised to keep all that it acknowledged, so it
 * ends when the disk fails. */
static const struct task_ops plain_ops = { settle, on_lack, NULL };
static const struct task_ops journal_ops = { settle, on_lack, on_broken };

static int
open_journal(struct store *s, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct rad_error why = { 0 };
    enum journal_how how;
    int rc = statedir_how(s->dir, &how, &why);

    snprintf(path, sizeof path, "%s/" STATEDIR_DATABASE, s->dir);
    if (rc == 0)
        rc = journal_open(&s->journal, path, how, &why);
    if (rc == 0)
        rc = journal_check(s->journal, &why);
    return rc == 0 ? 0 : store_refuse(s, &why, err);
}

static int
open_jobs(struct store *s, struct rad_error *err)
{
    int rc;

    memcpy(s->folder.dir, s->dir, sizeof s->dir);
    s->folder.durable = s->durable;
    rc = s->durable ? open_journal(s, err) : 0;
    return rc == 0 ? folder_init(&s->folder, err) : rc;
}

static int
open_dirs(struct store *s, const char *dir, struct rad_error *err)
{
    char files[BLOBS_DIR_MAX];
    int rc;

    if (snprintf(s->dir, sizeof s->dir, "%s", dir) >= (int)sizeof s->dir ||
        snprintf(files, sizeof files, "%s/files", dir) >= (int)sizeof files)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", dir);
    rc = rad_make_dir(dir, 0700, err);
    if (rc == 0 && s->handler->job)
        rc = statedir_check_owner(dir, err);
    if (rc == 0)
        rc = s->lock = service_lock_dir(dir, err);
    if (rc >= 0) /* jobs first: a refused folder is not changed */
        rc = s->handler->job ? open_jobs(s, err) : 0;
    if (rc == 0)
        rc = blobs_open(&s->blobs, files, err);
    if (rc == 0 && s->durable) /* names of files that an earlier life left */
        rc = disk_sync_path(s->blobs.dir, err);
    return rc == 0 && s->durable ? disk_sync_path(s->dir, err) : rc;
}

struct store *
store_open(uv_loop_t *loop, const char *dir, bool durable,
           const struct store_handler *handler, void *arg,
           struct rad_error *err)
{
    struct store *s = calloc(1, sizeof *s);
    struct rad_error why = { 0 };

    if (!s) {
        rad_fail_memory(err);
        return NULL;
    }
    s->handler = handler;
    s->arg = arg;
    s->durable = durable;
    s->lock = -1;
    task_queue_init(&s->queue, loop, &plain_ops, s);
    if (open_dirs(s, dir, &why) < 0) {
        if (err)
            *err = why;
        store_close(s);
        return NULL;
    }
    s->queue.gather = durable && handler->job;
    if (s->journal)
        s->queue.ops = &journal_ops;
    return s;
}

bool
store_idle(const struct store *s)
{
    return task_queue_idle(&s->queue);
}

size_t
store_backlog(const struct store *s)
{
    return s->backlog;
}

void
store_end(struct store *s)
{
    s->ending = true;
    task_queue_end(&s->queue);
}

void
store_close(struct store *s)
{
    if (!s)
        return;
    task_queue_release(&s->queue);
    store_release_arriving(s);
    cache_free(s->cache);
    if (s->journal) /* notes that were not committed are not acknowledged */
        journal_rollback(s->journal);
    journal_close(s->journal);
    folder_release(&s->folder);
    sounds_release(&s->sounds);
    if (s->lock >= 0)
        close(s->lock);
    free(s);
}
