/* store.c - see store.h
 *
 * Each request is a task that owns copies of all it needs.  The arriving files,
 * the job folders and the journal are the pool thread's; the loop never looks
 * at them once the jobs of earlier lives are recovered.
 *
 * What is noted in the journal is so before: files, then their names, then the
 * note.  What is removed is so after, but a folder that is forgotten, which
 * disappears at once: of that the journal may know a little longer. */
#include "config.h"

#include "store_impl.h"

#include "frame.h"
#include "job.h"
#include "log.h"
#include "rowcheck.h"
#include "rowsum.h"
#include "service.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

void *
store_new_task(struct store *s, size_t size, int (*run)(struct task *t),
               void (*done)(struct task *t))
{
    struct task *t = calloc(1, size);

    if (t) {
        t->run = run;
        t->done = done;
    } else {
        s->handler->broken(s->arg, EX_OSERR, "out of memory");
    }
    return t;
}

void
store_free_task(struct task *t)
{
    free(t);
}

void
store_push_lasting(struct store *s, struct task *t)
{
    t->writes = t->lasts = true;
    task_push(&s->queue, t);
}

struct settle_task {
    struct task task;
    struct store *store;
    uint64_t conn;
    uint32_t request;
};

static int
nothing_run(struct task *t)
{
    (void)t;
    return 0;
}

static void
settle_done(struct task *t)
{
    struct settle_task *w = (struct settle_task *)t;
    struct store *s = w->store;

    if (!is_mute(s, t))
        s->handler->settled(s->arg, w->conn, w->request);
    free(w);
}

void
store_settle(struct store *s, uint64_t conn, uint32_t request)
{
    struct settle_task *w =
        store_new_task(s, sizeof *w, nothing_run, settle_done);

    if (!w)
        return;
    w->store = s;
    w->conn = conn;
    w->request = request;
    store_push_lasting(s, &w->task);
}

/* --- jobs of earlier lives --- */

/* All that is needed of the store while it recovers. */
struct recovery {
    struct store *s;
    journal_job_fn *fn;
    void *arg;
};

/* Its scene is there, and is what it was. */
static int
check_files(struct store *s, const struct msg_spec *spec, struct rad_error *err)
{
    for (uint32_t i = 0; i < spec->files.n; i++) {
        const uint8_t *hash = spec->files.hash + (size_t)i * MSG_HASH;
        char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
        bool damaged;

        blobs_name(hash, name);
        blobs_path(&s->blobs, name, path);
        if (!sounds_check(&s->sounds, hash, path, &damaged))
            return rad_fail(err, RAD_EDATA, "file '%s' is %s", path,
                            damaged ? "damaged" : "missing");
    }
    return 0;
}

/* Rows that are not what they were are made again. */
static int
drop_damaged(void *arg, const struct saved_job *saved,
             const struct saved_unit *unit, struct rad_error *err)
{
    struct store *s = arg;
    char hex[MSG_JOB_HEX];

    msg_job_format(saved->spec.job, hex);
    log_warn("rows damaged job=%s frame=%u unit=%u: they are made again", hex,
             unit->area.frame, unit->unit);
    return journal_put_rows(s->journal, saved->spec.job, unit, err);
}

/* One that goes on, as far as its rows are sound. */
static int
recover_open(struct recovery *r, const struct saved_job *saved,
             struct rad_error *err)
{
    struct saved_unit *units = calloc(saved->nunits + 1, sizeof *units);
    struct saved_job sound = *saved;
    int rc;

    if (!units)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    sound.units = units;
    rc = rowcheck_job(&r->s->folder, saved, units, drop_damaged, r->s, err);
    if (rc == 0)
        rc = r->fn(r->arg, &sound, err);
    free(units);
    return rc;
}

static int
recover_one(void *arg, const struct saved_job *saved, struct rad_error *err)
{
    struct recovery *r = arg;
    bool over = saved->state >= JOB_DONE;
    int rc = 0;

    if (over && !folder_is_there(&r->s->folder, saved->spec.job)) {
        /* it was being forgotten */
        return journal_forget(r->s->journal, saved->spec.job, err);
    }
    if (!over)
        rc = check_files(r->s, &saved->spec, err);
    if (rc == 0)
        rc = folder_take_up(&r->s->folder, saved, over, err);
    if (rc == 0 && over)
        folder_rest(&r->s->folder, saved->spec.job);
    if (rc == 0 && !over)
        return recover_open(r, saved, err);
    return rc == 0 ? r->fn(r->arg, saved, err) : rc;
}

/* One that nobody was told is accepted. */
static int
drop_unknown(void *arg, const uint8_t job[MSG_JOB], struct rad_error *err)
{
    struct store *s = arg;
    bool has;
    int rc = journal_has(s->journal, job, &has, err);

    if (rc == 0 && !has)
        folder_forget(&s->folder, job);
    return rc;
}

int
store_refuse(const struct store *s, const struct rad_error *why,
             struct rad_error *err)
{
    if (why->code != RAD_EDATA && why->code != RAD_EIO) {
        *err = *why;
        return why->code;
    }
    rad_fail(err, why->code, "%.180s; 'radctl check' tells more", why->what);
    rad_error_where(err, "state folder '%.200s' is damaged", s->dir);
    return why->code;
}

int
store_recover(struct store *s, uint64_t now_ms, uint64_t *epoch,
              store_job_fn *fn, void *arg, struct rad_error *err)
{
    struct recovery r = { s, fn, arg };
    struct rad_error why = { 0 };
    int rc;

    *epoch = now_ms;
    if (!s->journal)
        return 0;
    rc = journal_begin_life(s->journal, now_ms, epoch, &why);
    if (rc == 0)
        rc = journal_read(s->journal, recover_one, &r, &why);
    if (rc == 0)
        rc = journal_commit(s->journal, &why);
    if (rc == 0)
        rc = folder_each(&s->folder, drop_unknown, s, &why);
    return rc == 0 ? 0 : store_refuse(s, &why, err);
}

bool
store_read_row(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame,
               uint32_t y, uint8_t *pixels)
{
    return folder_read_row(&s->folder, job, frame, y, pixels, NULL) == 0;
}

/* --- the whole --- */

/* One fdatasync for all rows that a group of tasks wrote to a file, one commit
 * for all that they noted. */
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
    return rc;
}

static void
on_fullness(void *arg, bool full, const char *text)
{
    struct store *s = arg;

    s->handler->fullness(s->arg, full, text);
}

static void
on_broken(void *arg, const struct rad_error *err)
{
    struct store *s = arg;

    s->handler->broken(s->arg, rad_exit_status(err->code), err->what);
}

/* With a journal what is acknowledged is kept, or the daemon ends. */
static const struct task_ops plain_ops = { settle, NULL, NULL };
static const struct task_ops journal_ops = { settle, on_fullness, on_broken };

static int
stranger(void *arg, const uint8_t job[MSG_JOB], struct rad_error *err)
{
    char hex[MSG_JOB_HEX];

    (void)arg;
    msg_job_format(job, hex);
    return rad_fail(err, RAD_EDATA, "there is a job %s, but no database", hex);
}

static int
open_journal(struct store *s, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct rad_error why = { 0 };
    bool there;
    int rc;

    snprintf(path, sizeof path, "%s/" STORE_DATABASE, s->dir);
    there = access(path, F_OK) == 0;
    rc = there ? 0 : folder_each(&s->folder, stranger, NULL, &why);
    if (rc == 0)
        rc = journal_open(&s->journal, path, JOURNAL_MAKE, &why);
    if (rc == 0)
        rc = there ? journal_check(s->journal, &why)
                   : disk_sync_dir(s->dir, &why);
    return rc == 0 ? 0 : store_refuse(s, &why, err);
}

static int
forget_one(void *arg, const uint8_t job[MSG_JOB], struct rad_error *err)
{
    (void)err;
    folder_forget(arg, job);
    return 0;
}

static int
open_jobs(struct store *s, struct rad_error *err)
{
    int rc;

    memcpy(s->folder.dir, s->dir, sizeof s->dir);
    s->folder.durable = s->durable;
    rc = folder_init(&s->folder, err);
    if (rc < 0)
        return rc;
    /* jobs that live in memory are nobody's any more */
    return s->durable ? open_journal(s, err)
                      : folder_each(&s->folder, forget_one, &s->folder, err);
}

static int
open_dirs(struct store *s, const char *dir, struct rad_error *err)
{
    char files[BLOBS_DIR_MAX];
    int rc;

    if (snprintf(s->dir, sizeof s->dir, "%s", dir) >= (int)sizeof s->dir ||
        snprintf(files, sizeof files, "%s/files", dir) >= (int)sizeof files)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", dir);
    rc = service_make_dir(dir, 0750, err);
    if (rc == 0)
        rc = s->lock = service_lock_dir(dir, err);
    if (rc >= 0)
        rc = blobs_open(&s->blobs, files, s->durable, err);
    return rc == 0 && s->handler->job ? open_jobs(s, err) : rc;
}

struct store *
store_open(uv_loop_t *loop, const char *dir, bool durable,
           const struct store_handler *handler, void *arg,
           struct rad_error *err)
{
    struct store *s = calloc(1, sizeof *s);
    struct rad_error why = { 0 };

    if (!s) {
        rad_fail(err, RAD_ENOMEM, "out of memory");
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
    if (s->journal) /* what did not last is nobody's */
        journal_rollback(s->journal);
    journal_close(s->journal);
    folder_release(&s->folder);
    sounds_release(&s->sounds);
    if (s->lock >= 0)
        close(s->lock);
    free(s);
}
