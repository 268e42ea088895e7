/* coord_job.c - the life of a job, as far as it is not the scheduler's
 *
 * A job waits until its bundle is stored and there is room for its rows; then
 * it is accepted.  It is over when every frame's picture is written, when it
 * failed, or when it was cancelled; it is then remembered, without its place
 * in the queue, for a while (struct coord_keep). */
#include "config.h"

#include "base/sha.h"
#include "sched.h"
#include "stats.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FETCH_MS 60000 /* in which a user gets a picture that is done */

struct job *
coord_find_job(const struct coord *c, const uint8_t id[MSG_JOB])
{
    for (size_t i = 0; i < c->njobs; i++)
        if (memcmp(c->jobs[i]->id, id, MSG_JOB) == 0)
            return c->jobs[i];
    return NULL;
}

void
coord_send_progress(struct coord *c, const struct coord_conn *conn,
                    const struct job *job)
{
    struct msg m = { .type = MSG_PROGRESS, .request = conn->watch_request };

    job_progress(job, c->now_ms, &m.progress);
    actions_send(&c->actions, conn->id, &m);
}

/* The last words to one who watches the job. */
void
coord_send_end(struct coord *c, const struct coord_conn *conn,
               const struct job *job)
{
    struct msg m = { .type = MSG_DONE,
                     .request = conn->watch_request,
                     .done = { job->id, job->spec.nframes } };

    coord_send_progress(c, conn, job);
    if (job->state == JOB_DONE)
        actions_send(&c->actions, conn->id, &m);
    else
        coord_reply_failed(c, conn, conn->watch_request, job->id, job->status,
                           job->text);
}

void
coord_send_accept(struct coord *c, const struct coord_conn *conn,
                  const struct job *job, bool again)
{
    struct msg m = { .type = MSG_ACCEPT,
                     .request = conn->watch_request,
                     .accept = { job->id, again } };

    actions_send(&c->actions, conn->id, &m);
}

/* NULL when memory is out. */
static struct coord_owner *
owner_of(struct coord *c, const char *name)
{
    struct coord_owner *o = c->owners;

    while (o && strcmp(o->name, name) != 0)
        o = o->next;
    if (o)
        return o;
    o = calloc(1, sizeof *o);
    if (!o)
        return NULL;
    snprintf(o->name, sizeof o->name, "%s", name);
    o->next = c->owners;
    return c->owners = o;
}

bool
coord_add_job(struct coord *c, struct job *job)
{
    size_t i = c->njobs;

    if (c->njobs == c->cap_jobs) {
        size_t cap = c->cap_jobs ? 2 * c->cap_jobs : 16;
        struct job **v = realloc(c->jobs, cap * sizeof *v);

        if (!v)
            return false;
        c->jobs = v;
        c->cap_jobs = cap;
    }
    job->payer = owner_of(c, job->owner);
    if (!job->payer)
        return false;
    while (i > 0 && c->jobs[i - 1]->spec.priority < job->spec.priority) {
        c->jobs[i] = c->jobs[i - 1];
        i--;
    }
    c->jobs[i] = job;
    c->njobs++;
    job->sequence = ++c->sequence;
    job->held = c->full;
    return true;
}

/* Once its files are all there, ask for room for its rows; workers load it
 * meanwhile. */
void
coord_try_open(struct coord *c, struct job *job)
{
    const struct msg_hashes *f = &job->spec.files;

    if (job->asked_open || job_over(job))
        return;
    for (uint32_t i = 0; i < f->n; i++)
        if (!c->env.has_file(c->env.arg, f->hash + (size_t)i * MSG_HASH))
            return;
    job->asked_open = c->stirred = true;
    actions_add_job(&c->actions, ACT_JOB_OPEN, 0, job->id);
}

/* What the store was to do for a job was done, or it failed with that status,
 * which ends it.  The job if it goes on; NULL. */
static struct job *
stored(struct coord *c, const uint8_t id[MSG_JOB], int status, const char *text)
{
    struct job *job = coord_find_job(c, id);

    if (!job || job_over(job))
        return NULL;
    if (status == 0)
        return job;
    coord_job_ends(c, job, JOB_FAILED, status, text);
    return NULL;
}

void
coord_job_opened(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                 int status, const char *text)
{
    struct job *job;

    c->now_ms = now_ms;
    job = stored(c, id, status, text);
    if (!job)
        return;
    job->opened = true;
    job->open_ms = now_ms;
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch == job)
            coord_send_accept(c, conn, job, false);
    sched_run(c);
}

/* Forget that job, of c->jobs. */
static void
forget(struct coord *c, size_t i)
{
    actions_log(&c->actions, ACT_INFO, "job forgotten job=%s", c->jobs[i]->hex);
    actions_add_job(&c->actions, ACT_JOB_FORGET, 0, c->jobs[i]->id);
    job_free(c->jobs[i]);
    memmove(c->jobs + i, c->jobs + i + 1, (c->njobs - i - 1) * sizeof *c->jobs);
    c->njobs--;
}

/* Forget the oldest of the jobs that are over while there are too many, or they
 * take too much room, or it is too old. */
void
coord_forget_old(struct coord *c)
{
    for (;;) {
        uint64_t bytes = 0;
        size_t over = 0, oldest = 0;

        for (size_t i = 0; i < c->njobs; i++) {
            if (!job_over(c->jobs[i]))
                continue;
            bytes += c->jobs[i]->kept_bytes;
            if (over++ == 0 || c->jobs[i]->end_ms < c->jobs[oldest]->end_ms)
                oldest = i;
        }
        if (over == 0 || (over <= c->keep.jobs &&
                          (c->keep.bytes == 0 || bytes <= c->keep.bytes ||
                           c->now_ms - c->jobs[oldest]->end_ms < FETCH_MS) &&
                          (c->keep.ms == 0 ||
                           c->now_ms - c->jobs[oldest]->end_ms < c->keep.ms)))
            return;
        forget(c, oldest);
    }
}

void
coord_set_keep(struct coord *c, const struct coord_keep *keep)
{
    c->keep = *keep;
    coord_forget_old(c);
}

/* The store learns how the job ended, if it knows it at all. */
static void
file_job(struct coord *c, const struct job *job)
{
    struct action *a;
    char *text;

    if (!c->env.keeps || !job->asked_open)
        return;
    text = stats_json(job, c->now_ms);
    a = actions_add_job(&c->actions, ACT_JOB_END, 0, job->id);
    if (!text || !a) {
        c->actions.failed = true;
    } else {
        a->len = strlen(text);
        a->bytes = rad_arena_dup(&c->actions.mem, (uint8_t *)text, a->len);
        c->actions.failed |= !a->bytes;
    }
    free(text);
}

void
coord_job_ends(struct coord *c, struct job *job, enum job_state state,
               int status, const char *text)
{
    if (job_over(job))
        return;
    job->state = state;
    job->status = status;
    job->end_ms = c->now_ms;
    snprintf(job->text, sizeof job->text, "%s", text ? text : "");
    wire_clean(job->text); /* JSON wants no half of a character */
    actions_log(&c->actions, ACT_INFO, "job over job=%s state=%s why=%s",
                job->hex, job_state_name(state), job->text);
    if (job->nan.pixels > 0)
        actions_log(&c->actions, ACT_WARN,
                    "pixels are no numbers job=%s pixels=%" PRIu64
                    " frame=%u x=%u y=%u",
                    job->hex, job->nan.pixels, job->nan.frame, job->nan.x,
                    job->nan.y);
    for (int i = 0; i < MSG_FAULTS && job->faults[i].count > 0; i++)
        actions_log(&c->actions, ACT_WARN,
                    "function has no value job=%s object=%u times=%" PRIu64,
                    job->hex, job->faults[i].object, job->faults[i].count);
    sched_job_over(c, job);
    file_job(c, job);
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch == job) {
            coord_send_end(c, conn, job);
            conn->watch = NULL;
        }
}

void
coord_picture_written(struct coord *c, uint64_t now_ms,
                      const uint8_t id[MSG_JOB], uint32_t frame, int status,
                      const char *text)
{
    struct job *job;

    c->now_ms = now_ms;
    job = stored(c, id, status, text);
    if (!job)
        return;
    job->frames[frame].writing = false;
    job->frames[frame].written = true;
    job_count_ready(job);
    if (job->frames_ready == job->spec.nframes)
        coord_job_ends(c, job, JOB_DONE, 0, NULL);
    coord_forget_old(c);
}

void
coord_job_filed(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                uint64_t bytes)
{
    struct job *job = coord_find_job(c, id);

    c->now_ms = now_ms;
    if (job)
        job->kept_bytes = bytes;
    coord_forget_old(c);
}

uint8_t *
coord_files(const struct coord *c, size_t *n)
{
    size_t all = 0, at = 0;
    uint8_t *list;

    for (size_t i = 0; i < c->njobs; i++)
        all += c->jobs[i]->spec.files.n;
    list = malloc(all * MSG_HASH + 1);
    if (!list)
        return NULL;
    for (size_t i = 0; i < c->njobs; i++) {
        const struct msg_hashes *f = &c->jobs[i]->spec.files;

        if (f->n > 0)
            memcpy(list + at * MSG_HASH, f->hash, (size_t)f->n * MSG_HASH);
        at += f->n;
    }
    *n = rad_sha_unique(list, all);
    return list;
}

bool
coord_saved(const struct coord *c, const uint8_t id[MSG_JOB],
            struct saved_job *out)
{
    const struct job *job = coord_find_job(c, id);

    if (!job)
        return false;
    *out = (struct saved_job){ .spec = job->spec,
                               .owner = job->owner,
                               .lives = job->lives,
                               .state = (uint8_t)job->state,
                               .status = job->status,
                               .text = job->text,
                               .offer_ms = job->offer_ms,
                               .submit_ms = job->submit_ms,
                               .open_ms = c->now_ms,
                               .end_ms = job->end_ms,
                               .sent_bytes = job->sent_bytes };
    job_progress(job, c->now_ms, &out->last);
    return true;
}
