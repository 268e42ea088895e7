/* request.c - see request.h */
#include "config.h"

#include "front/request.h"

#include "desk/desk.h"
#include "desk/verdict.h"
#include "front/delivery.h"
#include "front/intake.h"
#include "front/listing.h"
#include "front/reply.h"
#include "front/report.h"
#include "jobs/job.h"
#include "registry/bygone.h"
#include "registry/connlife.h"
#include "registry/joblife.h"
#include "registry/quota.h"
#include "sched/sched.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* --- jobs: requests of their owners and of admins --- */

/* The job that a request steers; NULL: there is no such job, it is over, or the
 * sender may not steer it; the sender is told. */
static struct job *
job_to_steer(struct coord *c, struct coord_conn *conn, uint32_t request,
             const uint8_t *id)
{
    struct job *job = reply_find_job(c, conn, request, id, false);

    if (!job || !job_over(job))
        return job;
    desk_reply_failed(c, conn, request, job->id, EX_USAGE, "the job is over");
    return NULL;
}

/* Log who steered the job. */
static void
log_job(struct coord *c, const struct coord_conn *conn, const char *what,
        const struct job *job)
{
    actions_log(&c->actions, ACT_INFO, "job %s job=%s by=%s", what, job->hex,
                conn->owner);
}

/* The job's owner is told who else cancelled it. */
static void
on_cancel(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_to_steer(c, conn, m->request, m->cancel.job);
    char text[MSG_MAX_TEXT + 1] = "cancelled";

    if (!job)
        return;
    log_job(c, conn, "cancelled", job);
    if (strcmp(conn->owner, job->owner) != 0)
        snprintf(text, sizeof text, "cancelled by administrator %s",
                 conn->owner);
    verdict_job(c, job, JOB_CANCELLED, EX_TEMPFAIL, text);
    joblife_end_all(c); /* so that the job's end is kept before the answer */
    reply_settled(c, conn, m->request);
}

static void
on_pause(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_to_steer(c, conn, m->request, m->pause.job);

    if (!job)
        return;
    log_job(c, conn, "paused", job);
    life_pause(job);
    joblife_keep_state(c, job);
    reply_settled(c, conn, m->request);
}

static void
on_resume(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_to_steer(c, conn, m->request, m->resume.job);

    if (!job)
        return;
    log_job(c, conn, "resumed", job);
    life_resume(job);
    joblife_keep_state(c, job);
    reply_settled(c, conn, m->request);
}

static void
on_delete(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = reply_find_job(c, conn, m->request, m->delete.job, false);

    if (!job)
        return;
    if (!job_over(job)) {
        desk_reply_failed(c, conn, m->request, job->id, EX_USAGE,
                          "the job is not over: cancel it first");
        return;
    }
    log_job(c, conn, "deleted", job);
    bygone_forget(c, job, GONE_DELETED);
    reply_settled(c, conn, m->request);
}

static void
on_priority(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct rad_error err = { 0 };
    struct job *job = job_to_steer(c, conn, m->request, m->priority.job);

    if (!job)
        return;
    if (quota_priority(m->priority.priority, &err) != 0) {
        desk_reply_failed(c, conn, m->request, job->id,
                          rad_exit_status(err.code), err.what);
        return;
    }
    joblife_set_priority(c, job, m->priority.priority);
    actions_log(&c->actions, ACT_INFO, "job priority job=%s priority=%d by=%s",
                job->hex, m->priority.priority, conn->owner);
    joblife_keep_state(c, job);
    reply_settled(c, conn, m->request);
}

/* --- queries --- */

/* Answer with the limits, and how much of each a user has: the sender, or for
 * an admin any user. */
static void
report_limits(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    const char *owner = m->query.text[0] ? m->query.text : conn->owner;
    char *text;

    if (conn->session == MSG_AT_COORD_USER && strcmp(owner, conn->owner) != 0) {
        desk_reply_failed(c, conn, m->request, NULL, EX_NOPERM,
                          "what another user has is for administrators");
        return;
    }
    text = quota_report(c, owner);
    if (text)
        reply_answer(c, conn, m->request, text);
    else
        c->actions.failed = true;
    free(text);
}

static void
on_query(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    int status;
    char *text;

    if (m->query.what == MSG_QUERY_LIMITS) {
        report_limits(c, conn, m);
        return;
    }
    text = report_query(c, m->query.what, m->query.text, &status);
    if (!text)
        c->actions.failed = true;
    else if (status != 0)
        desk_reply_failed(c, conn, m->request, NULL, status, text);
    else
        reply_answer(c, conn, m->request, text);
    free(text);
}

static void
on_page(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    char *text = listing_page(c, &m->page, conn->owner);

    if (text)
        reply_answer(c, conn, m->request, text);
    else
        c->actions.failed = true;
    free(text);
}

/* --- workers: requests of admins --- */

static void
log_worker(struct coord *c, const struct coord_conn *conn, const char *what,
           const struct coord_worker *w)
{
    actions_log(&c->actions, ACT_INFO, "worker %s name=%s by=%s", what, w->name,
                conn->owner);
}

/* Have the store keep whether the worker is drained. */
static void
keep_drained(struct coord *c, const struct coord_worker *w)
{
    struct action *a =
        c->env.keeps ? actions_add(&c->actions, ACT_DRAINED, 0) : NULL;

    if (!a)
        return;
    a->status = w->drained;
    a->text = actions_keep_text(&c->actions, w->name);
}

/* The worker of that name; NULL: there is none, and the sender is told. */
static struct coord_worker *
worker_of_request(struct coord *c, struct coord_conn *conn, uint32_t request,
                  const char *name)
{
    struct coord_worker *w = desk_find_worker(c, name);
    char text[MSG_MAX_TEXT + 1];

    if (w && !w->forgotten)
        return w;
    snprintf(text, sizeof text, "no worker '%s'", name);
    desk_reply_failed(c, conn, request, NULL, EX_NOINPUT, text);
    return NULL;
}

static void
set_drained(struct coord *c, struct coord_conn *conn, uint32_t request,
            const char *name, bool drained)
{
    struct coord_worker *w = worker_of_request(c, conn, request, name);

    if (!w)
        return;
    log_worker(c, conn, drained ? "drained" : "undrained", w);
    w->drained = drained;
    sched_drained(c, w);
    keep_drained(c, w);
    reply_settled(c, conn, request);
}

static void
on_drain(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    set_drained(c, conn, m->request, m->drain.name, true);
}

static void
on_undrain(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    set_drained(c, conn, m->request, m->undrain.name, false);
}

static void
on_forget(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct coord_worker *w =
        worker_of_request(c, conn, m->request, m->forget.name);

    if (!w)
        return;
    if (w->conn != 0) {
        desk_reply_failed(c, conn, m->request, NULL, EX_USAGE,
                          "the worker is connected: one that is gone can be "
                          "forgotten");
        return;
    }
    log_worker(c, conn, "forgotten", w);
    w->forgotten = true;
    w->drained = false;
    keep_drained(c, w);
    connlife_drop_forgotten(c);
    reply_settled(c, conn, m->request);
}

/* --- keys: requests of admins --- */

/* Pass the order on to the shell, which has the key file. */
static void
on_key(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action *a = actions_add(&c->actions, ACT_KEY, conn->id);

    if (!a)
        return;
    a->request = m->request;
    a->key = m->key;
    a->key.name = actions_keep_text(&c->actions, m->key.name);
    a->text = actions_keep_text(&c->actions, conn->owner);
}

/* Handlers of requests.  waits: the answer may wait for the disk, so a user may
 * have only so many under way (quota_answer()). */
static const struct {
    enum msg_type type;
    void (*handle)(struct coord *c, struct coord_conn *conn,
                   const struct msg *m);
    bool waits;
} handlers[] = {
    { MSG_OFFER, intake_offer, true },    { MSG_CHUNK, intake_chunk, false },
    { MSG_SUBMIT, intake_submit, false }, { MSG_CANCEL, on_cancel, true },
    { MSG_PAUSE, on_pause, true },        { MSG_RESUME, on_resume, true },
    { MSG_FETCH, delivery_fetch, true },  { MSG_QUERY, on_query, false },
    { MSG_DRAIN, on_drain, false },       { MSG_UNDRAIN, on_undrain, false },
    { MSG_KEY, on_key, false },           { MSG_PRIORITY, on_priority, true },
    { MSG_PAGE, on_page, false },         { MSG_DELETE, on_delete, true },
    { MSG_FORGET, on_forget, false },
};

void
request_handle(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++)
        if (handlers[i].type == m->type) {
            if (!handlers[i].waits || !reply_refused(c, conn, m, quota_answer))
                handlers[i].handle(c, conn, m);
            return;
        }
}
