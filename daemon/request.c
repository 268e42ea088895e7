/* request.c - see request.h */
#include "config.h"

#include "request.h"

#include "report.h"
#include "sched.h"
#include "stats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define MOST_JOBS 1000 /* that are not over */
#define FULL_MS   3000 /* an answer waits for room on the disk */

static void
reply_answer(struct coord *c, const struct coord_conn *conn, uint32_t request,
             const char *text)
{
    struct msg m = { .type = MSG_ANSWER,
                     .request = request,
                     .answer = { (const uint8_t *)text, strlen(text) } };

    if (m.answer.len > MSG_MAX - 4)
        coord_reply_failed(c, conn, request, NULL, EX_SOFTWARE,
                           "the answer is too long");
    else
        actions_send(&c->actions, conn->id, &m);
}

/* Done, and kept: nobody hears of what a crash could undo. */
static void
reply_settled(struct coord *c, struct coord_conn *conn, uint32_t request)
{
    struct coord_settling *s;
    struct action *a;

    if (!c->env.keeps) {
        reply_answer(c, conn, request, "");
        return;
    }
    s = calloc(1, sizeof *s);
    a = actions_add(&c->actions, ACT_SETTLE, conn->id);
    if (!a || !s) {
        free(s);
        c->actions.failed = true;
        return;
    }
    a->request = request;
    s->request = request;
    s->since_ms = c->now_ms;
    s->next = conn->settling;
    conn->settling = s;
}

static void
drop_settling(struct coord_settling **at)
{
    struct coord_settling *s = *at;

    *at = s->next;
    free(s);
}

void
request_settled(struct coord *c, struct coord_conn *conn, uint32_t request)
{
    struct coord_settling **at = &conn->settling;

    while (*at && (*at)->request != request)
        at = &(*at)->next;
    if (!*at)
        return; /* the disk was full for too long */
    drop_settling(at);
    reply_answer(c, conn, request, "");
}

/* Where a job waits for room, its end makes some, within a second; where it was
 * under way, that has to wait for room itself. */
static void
tell_unsettled(struct coord *c, struct coord_conn *conn)
{
    struct coord_settling **at = &conn->settling;

    while (*at) {
        if (c->now_ms - (*at)->since_ms < FULL_MS) {
            at = &(*at)->next;
            continue;
        }
        coord_reply_failed(c, conn, (*at)->request, NULL, EX_TEMPFAIL,
                           "it is done, but the coordinator's disk is full: a "
                           "restart before there is room would undo it");
        drop_settling(at);
    }
}

void
request_tick(struct coord *c)
{
    for (struct coord_conn *conn = c->conns; c->full && conn; conn = conn->next)
        tell_unsettled(c, conn);
}

void
request_release(struct coord_conn *conn)
{
    while (conn->settling)
        drop_settling(&conn->settling);
}

/* The job is as it is now after a restart too. */
static void
keep_state(struct coord *c, const struct job *job)
{
    struct action *a;

    if (!c->env.keeps || !job->asked_open)
        return;
    a = actions_add_job(&c->actions, ACT_JOB_STATE, 0, job->id);
    if (a)
        a->status = (int)job->state;
}

/* --- files --- */

void
request_looked(struct coord *c, struct coord_conn *conn,
               const struct action_look *l)
{
    struct msg want = { .type = MSG_WANT, .request = l->request };
    const struct msg_hashes *f = &l->files;
    uint8_t *list = rad_arena_alloc(&c->actions.mem, (size_t)f->n * MSG_HASH);

    if (!list) {
        c->actions.failed = true;
        return;
    }
    for (uint32_t i = 0; i < f->n; i++) {
        const uint8_t *hash = f->hash + (size_t)i * MSG_HASH;

        if (!c->env.has_file(c->env.arg, hash))
            memcpy(list + (size_t)want.want.n++ * MSG_HASH, hash, MSG_HASH);
    }
    want.want.hash = list;
    actions_send(&c->actions, conn->id, &want);
}

static void
on_offer(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action_look l = { .conn = conn->id,
                             .request = m->request,
                             .files = m->offer };

    if (conn->offer_ms == 0)
        conn->offer_ms = c->now_ms;
    if (!c->env.look || c->env.look(c->env.arg, &l))
        request_looked(c, conn, &l);
}

static void
on_chunk(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action *a = actions_add(&c->actions, ACT_PUT_CHUNK, conn->id);

    conn->sent_bytes += m->chunk.len;
    if (!a)
        return;
    a->request = m->request;
    a->chunk = m->chunk;
}

/* --- requests about jobs --- */

static bool
may_steer(const struct coord_conn *conn, const struct job *job)
{
    return conn->session == MSG_AT_COORD_ADMIN ||
           strcmp(conn->owner, job->owner) == 0;
}

/* The job that a request names, if there is one and the sender may steer it;
 * else NULL, and the sender is told. */
static struct job *
job_of_request(struct coord *c, struct coord_conn *conn, uint32_t request,
               const uint8_t *id)
{
    struct job *job = coord_find_job(c, id);

    if (!job) {
        coord_reply_failed(c, conn, request, id, EX_NOINPUT, "no such job");
        return NULL;
    }
    if (!may_steer(conn, job)) {
        coord_reply_failed(c, conn, request, id, EX_NOPERM,
                           "the job belongs to another user");
        return NULL;
    }
    return job;
}

/* Why a new job cannot be taken; 0: it can. */
static int
submit_fault(const struct coord *c, const struct msg_spec *spec,
             struct rad_error *err)
{
    struct partition_spec p;
    size_t active = 0;

    for (size_t i = 0; i < c->njobs; i++)
        active += !job_over(c->jobs[i]);
    if (active >= MOST_JOBS)
        return rad_fail(err, RAD_ETEMPFAIL, "the queue is full");
    if (job_partition_spec(spec, &p, err) != 0)
        return err->code;
    return partition_check(&p, err);
}

/* Somebody submits a job that is here already: attach to it. */
static void
attach(struct coord *c, struct coord_conn *conn, uint32_t request,
       const uint8_t *id)
{
    struct job *job = job_of_request(c, conn, request, id);

    if (!job)
        return;
    conn->watch_request = request;
    if (job->opened || job_over(job))
        coord_send_accept(c, conn, job, true);
    if (job_over(job))
        coord_send_end(c, conn, job);
    else
        conn->watch = job;
}

/* Rows come as they lie in the picture, unless distances come with them. */
static void
choose_coding(struct job *job)
{
    job->spec.flags &= ~MSG_JOB_CODED;
    if (!(job->spec.flags & MSG_JOB_DEPTH))
        job->spec.flags |= MSG_JOB_CODED;
}

static void
on_submit(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct rad_error err = { 0 };
    struct job *job;

    if (coord_find_job(c, m->submit.job)) {
        attach(c, conn, m->request, m->submit.job);
        return;
    }
    if (submit_fault(c, &m->submit, &err) != 0) {
        coord_reply_failed(c, conn, m->request, m->submit.job,
                           rad_exit_status(err.code), err.what);
        return;
    }
    job = job_new(&m->submit, conn->owner);
    if (!job || !coord_add_job(c, job)) {
        job_free(job);
        c->actions.failed = true;
        return;
    }
    choose_coding(job);
    job->submit_ms = c->now_ms;
    job->offer_ms = conn->offer_ms ? conn->offer_ms : c->now_ms;
    job->sent_bytes = conn->sent_bytes;
    conn->offer_ms = conn->sent_bytes = 0;
    conn->watch = job;
    conn->watch_request = m->request;
    actions_log(&c->actions, ACT_INFO, "job new job=%s owner=%s name=%s",
                job->hex, job->owner, job->spec.name);
    coord_try_open(c, job);
}

static void
on_cancel(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_of_request(c, conn, m->request, m->cancel.job);

    if (!job)
        return;
    coord_job_ends(c, job, JOB_CANCELLED, EX_TEMPFAIL, "cancelled");
    reply_settled(c, conn, m->request);
}

/* Nobody is to believe that a job that is over goes on. */
static bool
refuse_over(struct coord *c, struct coord_conn *conn, uint32_t request,
            const struct job *job)
{
    if (!job_over(job))
        return false;
    coord_reply_failed(c, conn, request, job->id, EX_USAGE, "the job is over");
    return true;
}

static void
on_pause(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_of_request(c, conn, m->request, m->pause.job);

    if (!job)
        return;
    if (refuse_over(c, conn, m->request, job))
        return;
    job->state = JOB_PAUSED;
    keep_state(c, job);
    reply_settled(c, conn, m->request);
}

static void
on_resume(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_of_request(c, conn, m->request, m->resume.job);

    if (!job)
        return;
    if (refuse_over(c, conn, m->request, job))
        return;
    if (job->state == JOB_PAUSED)
        job->state = job->first_ms ? JOB_RUNNING : JOB_WAITING;
    keep_state(c, job);
    reply_settled(c, conn, m->request);
}

/* Text as CHUNKs. */
static void
send_text(struct coord *c, const struct coord_conn *conn, uint32_t request,
          const char *text)
{
    size_t total = strlen(text);

    for (size_t at = 0; at < total; at += MSG_MAX_CHUNK) {
        size_t n = total - at < MSG_MAX_CHUNK ? total - at : MSG_MAX_CHUNK;
        struct msg m = { .type = MSG_CHUNK,
                         .request = request,
                         .chunk = { NULL, at, total, (const uint8_t *)text + at,
                                    n } };

        actions_send(&c->actions, conn->id, &m);
    }
}

static void
fetch_stats(struct coord *c, const struct coord_conn *conn, const struct msg *m,
            const struct job *job)
{
    char *text = stats_json(job, c->now_ms);

    if (text)
        send_text(c, conn, m->request, text);
    else
        c->actions.failed = true;
    free(text);
}

/* Why a frame cannot be fetched; NULL: it can. */
static const char *
fetch_fault(const struct job *job, const struct msg_fetch *m, int *status)
{
    *status = EX_USAGE;
    if (m->what == MSG_WHAT_STATS)
        return NULL;
    if (m->frame >= job->spec.nframes)
        return "no such frame";
    if (m->what == MSG_WHAT_DEPTH && !(job->spec.flags & MSG_JOB_DEPTH))
        return "the job has no distances";
    *status = EX_TEMPFAIL;
    if (m->what == MSG_WHAT_PREVIEW)
        return job->opened ? NULL : "nothing is rendered yet";
    if (job->frames[m->frame].written)
        return NULL;
    if (!job_over(job))
        return "the picture is not complete yet";
    if (job->state == JOB_CANCELLED) { /* who tries again tries in vain */
        *status = EX_NOINPUT;
        return "the job was cancelled: it has no picture";
    }
    *status = job->status;
    return job->text;
}

static void
on_fetch(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_of_request(c, conn, m->request, m->fetch.job);
    const char *fault;
    struct action *a;
    int status;

    if (!job)
        return;
    if (m->fetch.what == MSG_WHAT_STATS && !job->filed) {
        fetch_stats(c, conn, m, job);
        return;
    }
    fault = fetch_fault(job, &m->fetch, &status);
    if (fault) {
        coord_reply_failed(c, conn, m->request, job->id, status, fault);
        return;
    }
    a = actions_add_job(&c->actions, ACT_SEND_PICTURE, conn->id, job->id);
    if (!a)
        return;
    a->request = m->request;
    a->frame = m->fetch.frame;
    a->what = m->fetch.what;
}

static void
on_query(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    int status;
    char *text = report_query(c, m->query.what, m->query.text, &status);

    if (!text)
        c->actions.failed = true;
    else if (status != 0)
        coord_reply_failed(c, conn, m->request, NULL, status, text);
    else
        reply_answer(c, conn, m->request, text);
    free(text);
}

/* --- workers, by an admin --- */

static void
set_drained(struct coord *c, struct coord_conn *conn, uint32_t request,
            const char *name, bool drained)
{
    struct coord_worker *w = c->workers;
    char text[MSG_MAX_TEXT + 1];

    while (w && strcmp(w->name, name) != 0)
        w = w->next;
    if (!w) {
        snprintf(text, sizeof text, "no worker '%.200s'", name);
        coord_reply_failed(c, conn, request, NULL, EX_NOINPUT, text);
        return;
    }
    w->drained = drained;
    sched_drained(c, w);
    reply_answer(c, conn, request, "");
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

/* --- keys, by an admin --- */

/* The shell has the file. */
static void
on_key(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action *a = actions_add(&c->actions, ACT_KEY, conn->id);

    if (!a)
        return;
    a->request = m->request;
    a->key = m->key;
    a->key.name =
        rad_arena_strndup(&c->actions.mem, m->key.name, strlen(m->key.name));
    if (!a->key.name)
        c->actions.failed = true;
}

static const struct {
    enum msg_type type;
    void (*handle)(struct coord *c, struct coord_conn *conn,
                   const struct msg *m);
} handlers[] = {
    { MSG_OFFER, on_offer },   { MSG_CHUNK, on_chunk },
    { MSG_SUBMIT, on_submit }, { MSG_CANCEL, on_cancel },
    { MSG_PAUSE, on_pause },   { MSG_RESUME, on_resume },
    { MSG_FETCH, on_fetch },   { MSG_QUERY, on_query },
    { MSG_DRAIN, on_drain },   { MSG_UNDRAIN, on_undrain },
    { MSG_KEY, on_key },
};

void
request_handle(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++)
        if (handlers[i].type == m->type) {
            handlers[i].handle(c, conn, m);
            return;
        }
}
