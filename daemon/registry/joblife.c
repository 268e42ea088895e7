/* joblife.c - see joblife.h
 *
 * A job waits until its files are stored and there is room for its rows; then
 * the job is accepted.  It is over when all its pictures are written, when it
 * failed, or when it was cancelled; then it is remembered for a while (struct
 * coord_keep). */
#include "config.h"

#include "registry/joblife.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/linking.h"
#include "desk/order.h"
#include "jobs/job.h"
#include "jobs/progress.h"
#include "jobs/shared.h"
#include "desk/verdict.h"
#include "registry/connlife.h"
#include "registry/reuse.h"
#include "registry/stats.h"
#include "registry/telling.h"
#include "sched/sched.h"
#include "filling/passes.h"
#include "sched/survey.h"
#include "users/known.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

#define LOOK_FILES 512 /* files of a job that are looked for at a time */

void
joblife_send_progress(struct coord *c, const struct coord_conn *conn,
                      const struct job *job)
{
    struct msg m = { .type = MSG_PROGRESS, .request = conn->watch_request };

    progress_tell(job, c->now_ms, &m.progress);
    m.progress.workers = holding_workers(job);
    actions_send(&c->actions, conn->id, &m);
}

void
joblife_send_end(struct coord *c, const struct coord_conn *conn,
                 const struct job *job)
{
    struct msg m = { .type = MSG_DONE,
                     .request = conn->watch_request,
                     .done = { job->id, job->spec.nframes } };

    joblife_send_progress(c, conn, job);
    if (job->state == JOB_DONE)
        actions_send(&c->actions, conn->id, &m);
    else
        desk_reply_failed(c, conn, conn->watch_request, job->id, job->status,
                          job->text);
}

void
joblife_send_accept(struct coord *c, const struct coord_conn *conn,
                    const struct job *job, bool again)
{
    struct msg m = { .type = MSG_ACCEPT,
                     .request = conn->watch_request,
                     .accept = { job->id, again, job->spec.reuse } };

    actions_send(&c->actions, conn->id, &m);
}

bool
joblife_add(struct coord *c, struct job *job)
{
    job->payer = desk_owner(c, job->owner);
    if (!job->payer)
        return false;
    job->sequence = ++c->sequence;
    job->full = c->full;
    return order_add(c, job);
}

void
joblife_set_priority(struct coord *c, struct job *job, int32_t priority)
{
    job->spec.priority = priority;
    order_move(c, job);
    for (struct coord_worker *w = c->workers; w; w = w->next)
        holding_rate(c, w);
}

static void go_on_filing(struct coord *c, struct job *job);

static const uint8_t *
next_file(const struct job *job)
{
    return job->spec.files.hash + (size_t)job->nfound * MSG_HASH;
}

static bool
lacks_files(const struct job *job)
{
    return job->place == PLACE_ARRIVING && !job_over(job);
}

/* The job's workers may load it from PLACE_OPENING on.
 * A file counts as here only if the job's owner sent it: a user who knows only
 * the hash of another user's file gets no picture of that file.  This is called
 * for each file that comes, so the search goes on at the file where it ended.
 * To look for a file takes some microseconds, so of very many files the rest is
 * looked for later. */
void
joblife_try_open(struct coord *c, struct job *job)
{
    const struct msg_hashes *f = &job->spec.files;
    struct action *a;

    if (!lacks_files(job))
        return;
    for (uint32_t i = 0; i < LOOK_FILES && job->nfound < f->n; i++) {
        const uint8_t *hash = next_file(job);

        if (!known_has(&job->payer->files, hash) ||
            !c->env.has_file(c->env.arg, hash))
            return;
        job->nfound++;
        job->found_ms = c->now_ms;
    }
    if (job->nfound < f->n)
        return;
    if (!known_name(&job->payer->files, f))
        c->actions.failed = true;
    life_move(job, PLACE_OPENING);
    c->stirred = true;
    a = actions_add_job(&c->actions, ACT_JOB_OPEN, 0, job->id);
    if (a)
        a->sequence = job->sequence;
}

void
joblife_file_came(struct coord *c, const struct coord_owner *owner,
                  const uint8_t hash[MSG_HASH])
{
    for (size_t i = 0; i < c->nopen; i++) {
        struct job *job = c->jobs[i];

        if (job->payer == owner && lacks_files(job) &&
            job->nfound < job->spec.files.n &&
            memcmp(next_file(job), hash, MSG_HASH) == 0)
            joblife_try_open(c, job);
    }
}

/* End a job if no file of it has come for too long. */
static void
end_stalled(struct coord *c, struct job *job)
{
    char text[MSG_MAX_TEXT + 1];

    if (c->full) /* files cannot come while there is no room */
        job->found_ms = c->now_ms;
    if (c->now_ms - job->found_ms < c->limits.upload_ms)
        return;
    snprintf(text, sizeof text,
             "files of the scene did not come for %" PRIu64
             " s: submit it again",
             c->limits.upload_ms / 1000);
    verdict_job(c, job, JOB_FAILED, EX_TEMPFAIL, text);
}

/* Has the store the statistics of a job that is over?  The job stays as it is
 * for JOBLIFE_LINGER_MS, for its workers' last messages still come, and while
 * its statistics are made for a user. */
static bool
may_lighten(const struct coord *c, const struct job *job)
{
    return job->place == PLACE_KEPT &&
           c->now_ms - job->end_ms >= JOBLIFE_LINGER_MS && !telling_of(c, job);
}

static void
lighten(struct coord *c, struct job *job)
{
    progress_tell(job, c->now_ms, &job->last);
    job_lighten(job);
    order_move(c, job);
    connlife_drop_forgotten(c);
}

void
joblife_tick(struct coord *c)
{
    for (size_t i = c->nended; i-- > c->nopen;) {
        if (c->jobs[i]->filing)
            go_on_filing(c, c->jobs[i]);
        if (may_lighten(c, c->jobs[i]))
            lighten(c, c->jobs[i]);
    }
    for (size_t i = c->nbegun; i < c->nopen; i++) {
        if (!lacks_files(c->jobs[i]))
            continue;
        if (c->jobs[i]->nfound % LOOK_FILES == 0)
            joblife_try_open(c, c->jobs[i]);
        if (lacks_files(c->jobs[i]))
            end_stalled(c, c->jobs[i]);
    }
}

/* Take an answer of the store about a job; a status that is not 0 ends the job.
 * Returns the job if it goes on, else NULL. */
static struct job *
stored(struct coord *c, const uint8_t id[MSG_JOB], uint64_t sequence,
       int status, const char *text)
{
    struct job *job = desk_same_job(c, id, sequence);

    if (!job || job_over(job))
        return NULL;
    if (status == 0)
        return job;
    verdict_job(c, job, JOB_FAILED, status, text);
    return NULL;
}

void
joblife_keep_state(struct coord *c, const struct job *job)
{
    struct action *a;

    if (!c->env.keeps || job->place == PLACE_ARRIVING)
        return;
    a = actions_add_job(&c->actions, ACT_JOB_STATE, 0, job->id);
    if (!a)
        return;
    a->status = (int)job->state;
    a->priority = job->spec.priority;
}

/* The job has room now.  Tell the store of a pause or a change of priority: it
 * did not have the job until now. */
static void
wait_no_more(struct coord *c, struct job *job)
{
    job->text[0] = '\0';
    actions_log(&c->actions, ACT_INFO, "job has room job=%s", job->hex);
    joblife_keep_state(c, job);
}

void
joblife_opened(struct coord *c, const uint8_t id[MSG_JOB], uint64_t sequence,
               int status, const char *text)
{
    struct job *job = stored(c, id, sequence, status, text);
    bool waited;

    if (!job)
        return;
    waited = job->place == PLACE_NO_ROOM;
    life_move(job, PLACE_OPEN);
    job->open_ms = c->now_ms;
    passes_ask(c, job);
    if (waited)
        wait_no_more(c, job);
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch == job)
            joblife_send_accept(c, conn, job, false);
}

void
joblife_free(struct job *job)
{
    if (!job)
        return;
    stats_free(job->filing);
    passes_free(job->passes);
    survey_free(job->survey);
    shared_free(job->shared);
    linking_free(job->links);
    job_free(job);
}

void
joblife_drop(struct coord *c, struct job *job)
{
    order_remove(c, job);
    if (job->place != PLACE_ARRIVING)
        known_unname(&job->payer->files, c->now_ms, &job->spec.files);
    joblife_free(job);
    connlife_drop_forgotten(c);
}

/* Give the store the job's statistics and how the job ended. */
static void
file_text(struct coord *c, struct job *job)
{
    char *text = stats_take(job->filing);
    struct action *a;

    job->filing = NULL;
    if (!actions_own(&c->actions, text))
        return;
    a = actions_add_job(&c->actions, ACT_JOB_END, 0, job->id);
    if (!a)
        return;
    a->sequence = job->sequence;
    a->len = strlen(text);
    a->bytes = (uint8_t *)text;
}

/* Make the next piece of the statistics; the last goes to the store. */
static void
go_on_filing(struct coord *c, struct job *job)
{
    int rc = stats_more(job->filing, job, STATS_PIECE);

    if (rc < 0)
        c->actions.failed = true;
    else if (rc == 1)
        file_text(c, job);
}

static void
file_job(struct coord *c, struct job *job)
{
    if (!c->env.keeps || job->place == PLACE_ARRIVING)
        return;
    job->filing = stats_begin(job, c->now_ms);
    if (job->filing)
        go_on_filing(c, job);
    else
        c->actions.failed = true;
}

/* A job whose rows all come from an earlier life of the coordinator is over
 * before any worker is ready.  Take up its passes now, for their counts, and to
 * see whether all passes are there. */
static void
take_up_passes(struct coord *c, struct job *job)
{
    struct rad_error err = { 0 };

    if (!job->passes && job->kept.n > 0 && passes_begin(c, job, &err) != 0)
        actions_log(&c->actions, ACT_WARN, "passes lost job=%s why=%s",
                    job->hex, err.what);
}

/* Carry out the verdict on a job. */
static void
end_job(struct coord *c, struct job *job)
{
    job->ending = false;
    c->verdicts--;
    c->keep_due = true;
    actions_log(&c->actions, ACT_INFO, "job over job=%s state=%s why=%s",
                job->hex, job_state_name(job->state), job->text);
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
    take_up_passes(c, job);
    reuse_keep(c, job);
    sched_job_over(c, job);
    file_job(c, job);
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch == job) {
            joblife_send_end(c, conn, job);
            conn->watch = NULL;
        }
    order_move(c, job);
}

void
joblife_end_all(struct coord *c)
{
    for (size_t i = 0; i < c->nopen;)
        if (c->jobs[i]->ending)
            end_job(c, c->jobs[i]); /* which moves it behind the open jobs */
        else
            i++;
}

void
joblife_picture_written(struct coord *c, const uint8_t id[MSG_JOB],
                        uint64_t sequence, uint32_t frame, int status,
                        const char *text)
{
    struct job *job = stored(c, id, sequence, status, text);

    if (!job || frame >= job->spec.nframes ||
        job->frames[frame].state != FRAME_WRITING)
        return;
    frame_step(&job->frames[frame], FRAME_WRITTEN);
    job->unfetched++;
    frame_count_ready(job);
    if (job->frames_ready == job->spec.nframes)
        verdict_job(c, job, JOB_DONE, 0, NULL);
}
