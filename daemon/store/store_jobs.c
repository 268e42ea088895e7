/* store_jobs.c - jobs of the store: kept, over, forgotten
 *
 * A struct saved_job points at a specification, an owner and a text, so a task
 * needs copies of all these.  The specification is packed as a SUBMIT and
 * unpacked, which copies exactly what a message can carry.
 * A job's end takes two tasks: the first notes it; when the note is on the disk
 * the second removes the rows that are left and counts the bytes.  While the
 * disk is full the note has to wait, and the rows of a job that was cancelled
 * may be what fills it: then another task removes them before.
 * Forgetting a job takes three steps of one task: the folder is removed at
 * once, also while the disk is full, for that makes room; then the journal's
 * entry, which may have to wait; then the empty folder.
 *
 * radsubmit may give the id of a job that is gone to a new job.  The new job is
 * opened when the old job is forgotten and has no opening that still waits for
 * room: else the two would share a folder and an entry of the journal, and the
 * new job would lose both. */
#include "config.h"

#include "store/store_impl.h"

#include "jobs/job.h"
#include "net/log.h"
#include "proto/frame.h"
#include "files/views.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct job_task *
store_new_job_task(struct store *s, const uint8_t *id,
                   int (*run)(struct task *t), void (*done)(struct task *t))
{
    struct job_task *j = store_new_task(s, sizeof *j, run, done);

    memcpy(j->id, id, MSG_JOB);
    return j;
}

/* A task that keeps a job, or how the job ended; `saved` points at copies. */
struct saved_task {
    struct task task;
    uint8_t id[MSG_JOB];
    struct saved_job saved;
    struct wire_out bytes; /* the job's SUBMIT, packed */
    struct msg msg;        /* that SUBMIT, unpacked; `saved` points into it */
    char owner[MSG_MAX_NAME + 1], text[MSG_MAX_TEXT + 1];
    char *stats;
    size_t stats_len;
    struct saved_task *next; /* [loop] next in store.opening or .closing */
    bool pushed;             /* [loop] the task is in the queue */
    atomic_bool over;        /* the job is over before it was opened */
    bool opened;             /* [pool] the job was opened, maybe not settled */
};

/* A task that forgets a job, step by step. */
struct forget_task {
    struct task task;
    struct saved_gone gone;
    struct forget_task *next; /* [loop] next in store.forgetting */
};

static void
free_saved(struct saved_task *o)
{
    wire_out_release(&o->bytes);
    msg_release(&o->msg);
    free(o->stats);
    free(o);
}

static struct saved_task *
new_saved_task(struct store *s, const struct saved_job *from,
               int (*run)(struct task *t), void (*done)(struct task *t))
{
    struct msg m = { .type = MSG_SUBMIT, .submit = from->spec };
    struct saved_task *o = store_new_task(s, sizeof *o, run, done);

    memcpy(o->id, from->spec.job, MSG_JOB);
    wire_out_init(&o->bytes, MSG_FRAME_MAX);
    if (msg_pack(&o->bytes, &m) != 0 ||
        msg_unpack(&o->msg, MSG_SUBMIT, 0, o->bytes.buf + MSG_HEADER,
                   o->bytes.len - MSG_HEADER, NULL) != 0)
        log_out_of_memory();
    o->saved = *from;
    o->saved.spec = o->msg.submit;
    o->saved.last.job = o->id;
    snprintf(o->owner, sizeof o->owner, "%s", from->owner ? from->owner : "");
    snprintf(o->text, sizeof o->text, "%s", from->text ? from->text : "");
    o->saved.owner = o->owner;
    o->saved.text = o->text;
    return o;
}

/* The job waits for room on the disk; other jobs go on meanwhile. */
static void
open_waits(struct task *t)
{
    struct saved_task *o = (struct saved_task *)t;
    struct store *s = store_of(t);

    if (!s->ending)
        s->handler->waits(s->arg, o->id, o->saved.sequence, failure(t));
}

/* A job that is over is opened all the same if the task runs again because it
 * could not be settled: the task that notes the job's end runs again behind it.
 * If this one waited for room that other task has run.
 * A job whose files find no room waits alone.  If it is the database that is
 * full all tasks that write are held, for SQLite may have undone what others
 * have noted. */
static int
open_run(struct task *t)
{
    struct saved_task *o = (struct saved_task *)t;
    struct store *s = store_of(t);
    struct msg_spec whole = o->saved.spec;
    struct views views = { 0 };
    int rc;

    if (atomic_load(&o->over) &&
        (!o->opened || !folder_is_there(&s->folder, o->id)))
        return rad_fail(&t->err, RAD_ETEMPFAIL, "the job is over");
    rc = views_read(&views, s->blobs.dir, &whole, &t->err);
    if (rc == 0)
        rc = folder_make(&s->folder, &whole, &t->err);
    if (rc == 0 && whole.flags & MSG_JOB_REUSE)
        rc = folder_reuse(&s->folder, o->id, whole.reuse, &t->err);
    views_release(&views);
    t->waits = s->journal && rc < 0 ? open_waits : NULL;
    if (rc == 0 && s->journal)
        rc = journal_put_job(s->journal, &o->saved, &t->err);
    o->opened = rc == 0;
    return rc == RAD_EFULL ? store_shorten_log(s, rc, &t->err) : rc;
}

static int
noted_run(struct task *t)
{
    struct job_task *j = (struct job_task *)t;

    folder_noted(&store_of(t)->folder, j->id);
    return 0;
}

static bool
is_being_forgotten(const struct store *s, const uint8_t *id)
{
    for (const struct forget_task *f = s->forgetting; f; f = f->next)
        if (memcmp(f->gone.job, id, MSG_JOB) == 0)
            return true;
    return false;
}

/* Push the oldest task that opens a job of this id, unless that task is in the
 * queue already or an earlier job of the id is being forgotten. */
static void
push_opening(struct store *s, const uint8_t *id)
{
    struct saved_task *o = s->opening;

    while (o && memcmp(o->id, id, MSG_JOB) != 0)
        o = o->next;
    if (!o || o->pushed || is_being_forgotten(s, id))
        return;
    o->pushed = true;
    o->task.awaited = true;
    store_push_lasting(s, &o->task);
}

static void
open_done(struct task *t)
{
    struct saved_task *o = (struct saved_task *)t;
    struct store *s = store_of(t);
    struct saved_task **at = &s->opening;
    struct job_task *noted;

    while (*at != o)
        at = &(*at)->next;
    *at = o->next;
    push_opening(s, o->id);
    noted = t->code == 0 && s->journal
                ? store_new_job_task(s, o->id, noted_run, store_free_task)
                : NULL;
    if (noted)
        task_push(&s->queue, &noted->task);
    if (!is_mute(s, t))
        s->handler->job(s->arg, o->id, o->saved.sequence, status_of(t),
                        failure(t));
    free_saved(o);
}

void
store_open_job(struct store *s, const uint8_t job[MSG_JOB],
               const struct saved_job *saved)
{
    struct saved_job named = *saved;
    struct saved_task *o, **at = &s->opening;

    named.spec.job = job;
    o = new_saved_task(s, &named, open_run, open_done);
    while (*at)
        at = &(*at)->next;
    *at = o;
    push_opening(s, job);
}

/* Mark a job that is being opened as over, so that its task fails instead of
 * waiting for room, and tasks behind it can go on. */
static void
give_up_opening(struct store *s, const uint8_t *id)
{
    for (struct saved_task *o = s->opening; o; o = o->next)
        if (memcmp(o->id, id, MSG_JOB) == 0)
            atomic_store(&o->over, true);
}

/* Change the state of a job whose opening is not in the queue yet, so a task
 * that changes the state would come before the task that opens the job. */
static bool
put_state_early(struct store *s, const uint8_t *id, int state, int32_t priority)
{
    for (struct saved_task *o = s->opening; o; o = o->next)
        if (!o->pushed && !atomic_load(&o->over) &&
            memcmp(o->id, id, MSG_JOB) == 0) {
            o->saved.state = state;
            o->saved.spec.priority = priority;
            return true;
        }
    return false;
}

static int
state_run(struct task *t)
{
    struct job_task *j = (struct job_task *)t;

    return journal_put_state(store_of(t)->journal, j->id, j->state, j->priority,
                             &t->err);
}

void
store_put_state(struct store *s, const uint8_t job[MSG_JOB], int state,
                int32_t priority)
{
    struct job_task *j;

    if (!s->journal || put_state_early(s, job, state, priority))
        return;
    j = store_new_job_task(s, job, state_run, store_free_task);
    j->state = state;
    j->priority = priority;
    store_push_lasting(s, &j->task);
}

/* --- dates and workers --- */

struct date_task {
    struct task task;
    uint64_t date_ms;
};

static int
date_run(struct task *t)
{
    struct date_task *d = (struct date_task *)t;

    return journal_put_date(store_of(t)->journal, d->date_ms, &t->err);
}

void
store_note_date(struct store *s, uint64_t date_ms)
{
    struct date_task *d =
        s->journal ? store_new_task(s, sizeof *d, date_run, store_free_task)
                   : NULL;

    if (!d)
        return;
    d->date_ms = date_ms;
    store_push_lasting(s, &d->task);
}

struct worker_task {
    struct task task;
    char name[MSG_MAX_NAME + 1];
    bool drained;
};

static int
drained_run(struct task *t)
{
    struct worker_task *w = (struct worker_task *)t;

    return journal_put_drained(store_of(t)->journal, w->name, w->drained,
                               &t->err);
}

void
store_put_drained(struct store *s, const char *worker, bool drained)
{
    struct worker_task *w =
        s->journal ? store_new_task(s, sizeof *w, drained_run, store_free_task)
                   : NULL;

    if (!w)
        return;
    snprintf(w->name, sizeof w->name, "%s", worker);
    w->drained = drained;
    store_push_lasting(s, &w->task);
}

/* --- the end of a job --- */

static int
rest_run(struct task *t)
{
    struct job_task *j = (struct job_task *)t;
    struct store *s = store_of(t);

    folder_rest(&s->folder, j->id);
    j->bytes = folder_bytes(&s->folder, j->id);
    j->cache_bytes = folder_cache_bytes(&s->folder, j->id);
    return 0;
}

static void
rest_done(struct task *t)
{
    struct job_task *j = (struct job_task *)t;
    struct store *s = store_of(t);

    s->handler->filed(s->arg, j->id, j->sequence, j->bytes, j->cache_bytes);
    free(j);
}

static int
end_run(struct task *t)
{
    struct saved_task *o = (struct saved_task *)t;
    struct store *s = store_of(t);
    int rc;

    if (!folder_is_there(&s->folder, o->id))
        return 0; /* the job was forgotten while this task was held */
    /* its new name is synced with that of the statistics */
    if (o->saved.cache_bytes > 0)
        folder_keep_cache(&s->folder, o->id, &o->saved.keep);
    rc = folder_stats(&s->folder, o->id, o->stats, o->stats_len,
                      &o->saved.stats, &t->err);
    o->saved.kept_bytes = folder_bytes(&s->folder, o->id);
    return rc < 0 ? rc : journal_put_end(s->journal, &o->saved, &t->err);
}

static void
end_done(struct task *t)
{
    struct saved_task *o = (struct saved_task *)t;
    struct store *s = store_of(t);
    struct saved_task **at = &s->closing;
    struct job_task *j;

    while (*at != o)
        at = &(*at)->next;
    *at = o->next;
    if (!is_mute(s, t)) {
        j = store_new_job_task(s, o->id, rest_run, rest_done);
        j->sequence = o->saved.sequence;
        task_push(&s->queue, &j->task);
    }
    free_saved(o);
}

static int
give_up_run(struct task *t)
{
    struct job_task *j = (struct job_task *)t;

    folder_give_up(&store_of(t)->folder, j->id);
    return 0;
}

/* Remove the rows of a job that ends because it was cancelled; those of another
 * job may be of pictures that wait to be written.  No writing task, for it
 * makes room. */
static void
give_up_rows(struct store *s, const struct saved_task *end)
{
    struct job_task *j =
        end->saved.state == JOB_CANCELLED
            ? store_new_job_task(s, end->id, give_up_run, store_free_task)
            : NULL;

    if (j)
        task_push(&s->queue, &j->task);
}

void
store_make_room(struct store *s)
{
    for (const struct saved_task *o = s->closing; o; o = o->next)
        give_up_rows(s, o);
}

void
store_end_job(struct store *s, const struct saved_job *saved, char *stats,
              size_t len)
{
    struct saved_task *o =
        s->journal ? new_saved_task(s, saved, end_run, end_done) : NULL;

    give_up_opening(s, saved->spec.job);
    if (!o) {
        free(stats);
        return;
    }
    o->stats = stats;
    o->stats_len = len;
    o->next = s->closing;
    s->closing = o;
    if (s->full)
        give_up_rows(s, o);
    store_push_lasting(s, &o->task);
}

static int
drop_cache_run(struct task *t)
{
    struct job_task *j = (struct job_task *)t;
    struct store *s = store_of(t);

    folder_drop_cache(&s->folder, j->id);
    j->bytes = folder_bytes(&s->folder, j->id);
    return 0;
}

/* The task does not count as writing: it may run while the disk is full, and
 * makes room. */
void
store_drop_cache(struct store *s, const uint8_t job[MSG_JOB], uint64_t sequence)
{
    struct job_task *j = store_new_job_task(s, job, drop_cache_run, rest_done);

    j->sequence = sequence;
    task_push(&s->queue, &j->task);
}

static int
fetched_run(struct task *t)
{
    struct job_task *j = (struct job_task *)t;

    return journal_put_fetched(store_of(t)->journal, j->id, j->frame, &t->err);
}

void
store_note_fetched(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame)
{
    struct job_task *j =
        s->journal ? store_new_job_task(s, job, fetched_run, store_free_task)
                   : NULL;

    if (!j)
        return;
    j->frame = frame;
    store_push_lasting(s, &j->task);
}

/* --- a job is forgotten --- */

/* A large folder is removed in pieces, so that other tasks run between them. */
static int
forget_run(struct task *t)
{
    struct forget_task *f = (struct forget_task *)t;
    struct store *s = store_of(t);
    struct folder *folder = &s->folder;
    bool more = folder_forget(folder, f->gone.job);

    if (!more && !s->journal)
        folder_forgotten(folder, f->gone.job);
    return more;
}

static int
strike_run(struct task *t)
{
    struct forget_task *f = (struct forget_task *)t;

    return journal_forget(store_of(t)->journal, &f->gone, &t->err);
}

static int
forgotten_run(struct task *t)
{
    struct forget_task *f = (struct forget_task *)t;

    folder_forgotten(&store_of(t)->folder, f->gone.job);
    return 0;
}

/* The job is forgotten, or the store ends before it is.  A new job of the same
 * id is opened, or fails: the journal still has the entry of the old job. */
static void
forgotten_done(struct task *t)
{
    struct forget_task *f = (struct forget_task *)t;
    struct store *s = store_of(t);
    struct forget_task **at = &s->forgetting;

    while (*at != f)
        at = &(*at)->next;
    *at = f->next;
    if (t->code < 0)
        give_up_opening(s, f->gone.job);
    push_opening(s, f->gone.job);
    free(f);
}

static void
strike_done(struct task *t)
{
    if (t->code < 0) {
        forgotten_done(t);
        return;
    }
    t->run = forgotten_run;
    t->done = forgotten_done;
    t->writes = t->lasts = false;
    task_push(&store_of(t)->queue, t);
}

static void
forget_done(struct task *t)
{
    struct store *s = store_of(t);

    if (t->code > 0) {
        task_push(&s->queue, t);
    } else if (!s->journal) {
        forgotten_done(t);
    } else {
        t->run = strike_run;
        t->done = strike_done;
        store_push_lasting(s, t);
    }
}

void
store_forget_job(struct store *s, const struct saved_gone *gone)
{
    struct forget_task *f =
        store_new_task(s, sizeof *f, forget_run, forget_done);

    f->gone = *gone;
    f->next = s->forgetting;
    s->forgetting = f;
    /* not a writing task: it may run while the disk is full, and makes room */
    task_push(&s->queue, &f->task);
}
