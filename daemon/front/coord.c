/* coord.c - see coord.h
 *
 * Events come in here; messages go to tables of handlers: workers.c, request.c.
 * Whether a message may come from its sender was checked before, by the session
 * (proto/message.def).  connlife.c has the life of connections, joblife.c the
 * life of jobs; sched.c says which worker gets what; intake.c and delivery.c
 * answer users. */
#include "config.h"

#include "front/coord.h"

#include "desk/desk.h"
#include "desk/linking.h"
#include "jobs/job.h"
#include "jobs/progress.h"
#include "desk/verdict.h"
#include "front/coord_files.h"
#include "front/delivery.h"
#include "front/intake.h"
#include "front/reply.h"
#include "front/request.h"
#include "front/workers.h"
#include "registry/bygone.h"
#include "registry/connlife.h"
#include "registry/joblife.h"
#include "registry/telling.h"
#include "filling/passes.h"
#include "sched/result.h"
#include "sched/sched.h"
#include "users/known.h"
#include "users/uploads.h"

#include "base/text.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PROGRESS_MS  500   /* between two PROGRESS of a job */
#define FULL_TELL_MS 60000 /* between two log lines that the disk is full */
#define LEASE_MS     60000
#define KEPT_JOBS    100 /* jobs that are over and remembered, at first */
#define KEPT_CACHES  (UINT64_C(2) << 30)

/* More than a room of people needs, and less than would harm others. */
static const struct coord_limits usual_limits = {
    .jobs = 1000,
    .frames = 200000,
    .bytes = UINT64_C(1) << 40,
    .uploads = 200,
    .upload_bytes = UINT64_C(1) << 36,
    .conns = 256,
    .answers = 1000,
    .unfetched = 1000,
    .unread = UINT64_C(32) << 20,
    .upload_ms = 3600 * 1000,
};

struct coord *
coord_new(const struct coord_env *env)
{
    struct coord *c = calloc(1, sizeof *c);

    if (!c)
        return NULL;
    c->env = *env;
    c->keep.jobs = KEPT_JOBS;
    c->keep.cache_bytes = KEPT_CACHES;
    c->lease_floor_ms = LEASE_MS;
    c->limits = usual_limits;
    actions_init(&c->actions);
    return c;
}

void
coord_set_lease_floor(struct coord *c, uint64_t ms)
{
    c->lease_floor_ms = ms;
}

void
coord_set_limits(struct coord *c, const struct coord_limits *limits)
{
    c->limits = *limits;
}

void
coord_free(struct coord *c)
{
    if (!c)
        return;
    while (c->conns) {
        struct coord_conn *next = c->conns->next;

        telling_release(c->conns);
        free(c->conns);
        c->conns = next;
    }
    while (c->workers) {
        struct coord_worker *next = c->workers->next;

        free(c->workers);
        c->workers = next;
    }
    uploads_release(&c->uploads);
    while (c->owners) {
        struct coord_owner *next = c->owners->next;

        known_release(&c->owners->files);
        free(c->owners);
        c->owners = next;
    }
    for (size_t i = 0; i < c->njobs; i++)
        joblife_free(c->jobs[i]);
    free(c->gones);
    free(c->jobs);
    actions_release(&c->actions);
    free(c);
}

void
coord_set_epoch(struct coord *c, uint64_t epoch)
{
    c->env.epoch = epoch;
}

struct action_list *
coord_actions(struct coord *c)
{
    assert(c->verdicts == 0); /* no verdict outlives its event */
    return &c->actions;
}

/* --- messages --- */

static void
handle(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    if (conn->session == MSG_AT_COORD_USER ||
        conn->session == MSG_AT_COORD_ADMIN ||
        conn->session == MSG_AT_COORD_OBSERVER)
        request_handle(c, conn, m);
    else if (m->type == MSG_HELLO)
        connlife_hello(c, conn, m);
    else if (conn->worker)
        workers_handle(c, conn->worker, m);
}

/* --- events --- */

/* Carry out all verdicts.  In a loop, for the end of a worker's connection may
 * be the end of a job, if a unit was lost once too often. */
static void
carry_out_verdicts(struct coord *c)
{
    while (c->verdicts > 0) {
        joblife_end_all(c);
        connlife_end_all(c);
    }
}

/* End an event: carry out verdicts, then give work to workers that may get
 * some, which may bring further verdicts.  run: any worker may get work. */
static void
settle(struct coord *c, bool run)
{
    carry_out_verdicts(c);
    if (run || c->stirred)
        sched_run(c);
    else if (c->roomy)
        sched_run_for(c, c->roomy);
    c->roomy = NULL;
    carry_out_verdicts(c);
}

void
coord_opened(struct coord *c, uint64_t now_ms, uint64_t id,
             const struct coord_peer *peer)
{
    c->now_ms = now_ms;
    connlife_opened(c, id, peer);
    settle(c, false);
}

void
coord_closed(struct coord *c, uint64_t now_ms, uint64_t id, const char *why)
{
    bool known = desk_find_conn(c, id);

    c->now_ms = now_ms;
    connlife_closed(c, id, why);
    if (known)
        settle(c, true);
}

/* Is the message part of a worker's usual work?  Such messages are many, so
 * workers get work after them only if a handler sets stirred or roomy. */
static bool
is_work(uint16_t type)
{
    return type == MSG_FACTS || type == MSG_BASE_LINE || type == MSG_GUESS ||
           type == MSG_RESULT || type == MSG_TALLY || type == MSG_LINE_COSTS ||
           type == MSG_RECORDS || type == MSG_TILE_MADE || type == MSG_PING ||
           type == MSG_PONG;
}

void
coord_message(struct coord *c, uint64_t now_ms, uint64_t id,
              const struct msg *m)
{
    struct coord_conn *conn = desk_find_conn(c, id);

    c->now_ms = now_ms;
    if (!conn || !msg_allowed(conn->session, m->type))
        return; /* the message came while its connection was being closed */
    handle(c, conn, m);
    settle(c, !is_work(m->type));
}

void
coord_looked(struct coord *c, uint64_t now_ms, const struct action_look *l)
{
    struct coord_conn *conn = desk_find_conn(c, l->conn);

    c->now_ms = now_ms;
    if (!conn)
        return;
    conn->answers--;
    intake_looked(c, conn, l);
}

bool
coord_has_file(const struct coord *c, uint64_t id, const uint8_t hash[MSG_HASH])
{
    const struct coord_conn *conn = desk_find_conn(c, id);

    return conn && known_has(&conn->payer->files, hash);
}

void
coord_sent(struct coord *c, uint64_t id)
{
    struct coord_conn *conn = desk_find_conn(c, id);

    if (conn && conn->answers > 0)
        conn->answers--;
}

void
coord_file_stored(struct coord *c, uint64_t now_ms, uint64_t id,
                  const uint8_t hash[MSG_HASH])
{
    struct coord_conn *conn = desk_find_conn(c, id);
    struct msg m = { .type = MSG_HAVE, .have = { hash } };
    struct coord_owner *owner;

    c->now_ms = now_ms;
    if (!conn)
        return; /* the user will be asked for the file again */
    owner = conn->payer;
    if (!known_sent(&owner->files, now_ms, hash)) {
        c->actions.failed = true;
        return;
    }
    actions_send(&c->actions, id, &m);
    uploads_whole(&c->uploads, id, hash, now_ms);
    joblife_file_came(c, owner, hash);
    settle(c, false);
}

void
coord_file_failed(struct coord *c, uint64_t now_ms, uint64_t id,
                  const uint8_t hash[MSG_HASH], int status, const char *text)
{
    struct coord_conn *conn = desk_find_conn(c, id);

    c->now_ms = now_ms;
    uploads_failed(&c->uploads, id, hash);
    if (conn)
        desk_reply_failed(c, conn, 0, NULL, status, text);
}

void
coord_settled(struct coord *c, uint64_t now_ms, uint64_t id, uint32_t request)
{
    struct coord_conn *conn = desk_find_conn(c, id);

    c->now_ms = now_ms;
    if (conn)
        reply_kept(c, conn, request);
}

void
coord_rows_stored(struct coord *c, uint64_t now_ms,
                  const struct action_rows *key, int status, const char *text)
{
    struct job *job = desk_same_job(c, key->job, key->sequence);

    c->now_ms = now_ms;
    if (status == 0)
        result_stored(c, key);
    else if (job)
        verdict_job(c, job, JOB_FAILED, status, text);
    settle(c, true);
}

void
coord_job_opened(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                 uint64_t sequence, int status, const char *text)
{
    c->now_ms = now_ms;
    joblife_opened(c, id, sequence, status, text);
    settle(c, true);
}

void
coord_picture_written(struct coord *c, uint64_t now_ms,
                      const uint8_t id[MSG_JOB], uint64_t sequence,
                      uint32_t frame, int status, const char *text)
{
    c->now_ms = now_ms;
    joblife_picture_written(c, id, sequence, frame, status, text);
    settle(c, false);
}

void
coord_job_filed(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                uint64_t sequence, uint64_t bytes, uint64_t cache_bytes)
{
    struct job *job = desk_same_job(c, id, sequence);

    c->now_ms = now_ms;
    if (job) {
        job->kept_bytes = bytes;
        job->cache.bytes = cache_bytes;
        if (c->env.keeps && job->place < PLACE_KEPT)
            life_move(job, PLACE_KEPT);
    }
    c->keep_due = true;
}

void
coord_cache_came(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                 uint64_t sequence, const struct saved_cache *cache)
{
    struct job *job = desk_same_job(c, id, sequence);

    c->now_ms = now_ms;
    if (job && !job_over(job))
        passes_came(c, job, cache);
    else
        free(cache->records);
    settle(c, true);
}

/* Tell a user whose files the store does not take that the disk is full: there
 * is no job yet whose state could tell. */
static void
say_held(struct coord *c, const struct coord_conn *conn)
{
    struct msg m = { .type = MSG_PROGRESS,
                     .progress = { .state = MSG_STATE_HELD } };

    actions_send(&c->actions, conn->id, &m);
}

/* Log that the disk is full, or has room again.  A disk at its limit is full
 * and has room by turns, so the log tells of a full disk at most once in
 * FULL_TELL_MS. */
static void
log_fullness(struct coord *c)
{
    if (c->full && !c->full_told &&
        (c->full_told_ms == 0 || c->now_ms - c->full_told_ms >= FULL_TELL_MS)) {
        actions_log(&c->actions, ACT_ERR, "disk full, jobs are held why=%s",
                    c->full_text);
        c->full_told = true;
        c->full_told_ms = c->now_ms;
    } else if (!c->full && c->full_told) {
        actions_log(&c->actions, ACT_INFO, "disk has room, jobs go on");
        c->full_told = false;
    }
}

void
coord_fullness(struct coord *c, uint64_t now_ms, bool full, const char *text)
{
    c->now_ms = now_ms;
    c->full = full;
    rad_text_print(c->full_text, sizeof c->full_text, "no room on the disk: %s",
                   text);
    wire_clean(c->full_text);
    log_fullness(c);
    for (size_t i = 0; i < c->njobs; i++)
        c->jobs[i]->full = full;
    c->told_progress_ms = 0; /* users hear of it at the next tick */
    settle(c, true);
}

void
coord_expel(struct coord *c, uint64_t now_ms, const char *name)
{
    struct coord_worker *w = desk_find_worker(c, name);

    c->now_ms = now_ms;
    if (!w)
        return;
    w->expelled = true;
    for (size_t i = 0; i < c->nopen; i++)
        linking_drop(c, c->jobs[i], w);
}

void
coord_job_waits(struct coord *c, uint64_t now_ms, const uint8_t id[MSG_JOB],
                uint64_t sequence, const char *text)
{
    struct job *job = desk_same_job(c, id, sequence);

    c->now_ms = now_ms;
    if (!job || job_over(job))
        return;
    if (job->place != PLACE_NO_ROOM)
        life_move(job, PLACE_NO_ROOM);
    rad_text_print(job->text, sizeof job->text, "no room on the disk: %s",
                   text);
    wire_clean(job->text);
    actions_log(&c->actions, ACT_WARN, "job waits for room job=%s why=%s",
                job->hex, text);
    c->told_progress_ms = 0; /* users hear of it at the next tick */
}

bool
coord_saved(const struct coord *c, const uint8_t id[MSG_JOB],
            struct saved_job *out)
{
    const struct job *job = desk_find_job(c, id);
    uint64_t date_ms = desk_date_ms(c), slept_ms = date_ms - c->now_ms;

    if (!job)
        return false;
    *out = (struct saved_job){ .spec = job->spec,
                               .owner = job->owner,
                               .sequence = job->sequence,
                               .lives = job->lives,
                               .state = (uint8_t)job->state,
                               .status = job->status,
                               .text = job->text,
                               .offer_ms = job->offer_ms + slept_ms,
                               .submit_ms = job->submit_ms + slept_ms,
                               .open_ms = date_ms,
                               .end_ms = job->over_ms,
                               .cache_bytes = job->cache.bytes,
                               .keep = job->cache.range,
                               .sent_bytes = job->sent_bytes };
    progress_tell(job, c->now_ms, &out->last);
    return true;
}

void
coord_set_keep(struct coord *c, const struct coord_keep *keep)
{
    c->keep = *keep;
    c->keep_due = true;
    bygone_forget_old(c);
}

void
coord_tick(struct coord *c, uint64_t now_ms)
{
    c->now_ms = now_ms;
    log_fullness(c);
    sched_tick(c);
    settle(c, false);
    delivery_tick(c);
    reply_tick(c);
    coord_files_tick(c);
    joblife_tick(c);
    settle(c, false);
    bygone_forget_old(c);
    coord_files_expire(c);
    if (now_ms - c->told_progress_ms < PROGRESS_MS)
        return;
    c->told_progress_ms = now_ms;
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->watch)
            joblife_send_progress(c, conn, conn->watch);
        else if (c->full && conn->offer_ms != 0)
            say_held(c, conn);
}
