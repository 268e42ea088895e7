/* request.c - see request.h */
#include "config.h"

#include "front/request.h"

#include "desk/desk.h"
#include "desk/verdict.h"
#include "front/listing.h"
#include "front/report.h"
#include "jobs/job.h"
#include "queue/coord_conn.h"
#include "queue/coord_job.h"
#include "queue/coord_keep.h"
#include "queue/quota.h"
#include "queue/reuse.h"
#include "queue/stats.h"
#include "queue/telling.h"
#include "sched/sched.h"
#include "users/known.h"
#include "users/uploads.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define MOST_JOBS 20000 /* of all users, that are not over */
#define FULL_MS   3000  /* an answer waits for room on the disk */

/* Of statistics that are whole, in a tick: well below a millisecond. */
#define TELL_BYTES ((size_t)4 * MSG_MAX_CHUNK)

static void
reply_answer(struct coord *c, const struct coord_conn *conn, uint32_t request,
             const char *text)
{
    struct msg m = { .type = MSG_ANSWER,
                     .request = request,
                     .answer = { (const uint8_t *)text, strlen(text) } };

    if (m.answer.len > MSG_MAX - 4)
        desk_reply_failed(c, conn, request, NULL, EX_SOFTWARE,
                          "the answer is too long");
    else
        actions_send(&c->actions, conn->id, &m);
}

/* Answer a request once the store keeps the change: a user does not hear of a
 * change that a crash could undo. */
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
    conn->answers++;
}

void
request_settled(struct coord *c, struct coord_conn *conn, uint32_t request)
{
    struct coord_settling **at = &conn->settling;

    while (*at && (*at)->request != request)
        at = &(*at)->next;
    if (!*at)
        return; /* the disk was full for too long */
    telling_drop_settling(conn, at);
    reply_answer(c, conn, request, "");
}

/* While the disk is full: the end of a job that waits for room makes room
 * within a second, but that of a job under way has to wait for room itself. */
static void
tell_unsettled(struct coord *c, struct coord_conn *conn)
{
    struct coord_settling **at = &conn->settling;

    while (*at) {
        if (c->now_ms - (*at)->since_ms < FULL_MS) {
            at = &(*at)->next;
            continue;
        }
        desk_reply_failed(c, conn, (*at)->request, NULL, EX_TEMPFAIL,
                          "it is done, but the coordinator's disk is full: a "
                          "restart before there is room would undo it");
        telling_drop_settling(conn, at);
    }
}

static void tell_all(struct coord *c);

void
request_tick(struct coord *c)
{
    tell_all(c);
    for (struct coord_conn *conn = c->conns; c->full && conn; conn = conn->next)
        tell_unsettled(c, conn);
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

        if (i >= l->nlook || !c->env.has_file(c->env.arg, hash))
            memcpy(list + (size_t)want.want.n++ * MSG_HASH, hash, MSG_HASH);
    }
    want.want.hash = list;
    actions_send(&c->actions, conn->id, &want);
}

/* Sort what is offered: first what this user may know to be here, for which the
 * store is looked at.  All else is wanted without a look, whose time would
 * tell, too, what others have sent. */
static bool
sort_offer(struct coord *c, struct known *files, struct action_look *l,
           const struct msg_hashes *offer)
{
    size_t bytes = (size_t)offer->n * MSG_HASH;
    uint8_t *list = rad_arena_alloc(&c->actions.mem, bytes), *end = list;

    if (!list)
        return false;
    for (int here = 1; here >= 0; here--) {
        for (uint32_t i = 0; i < offer->n; i++) {
            const uint8_t *hash = offer->hash + (size_t)i * MSG_HASH;

            if (known_has(files, hash) != here)
                continue;
            memcpy(end, hash, MSG_HASH);
            end += MSG_HASH;
            l->nlook += (uint32_t)here;
        }
    }
    l->files = (struct msg_hashes){ offer->n, list };
    for (uint32_t i = 0; i < l->nlook; i++)
        if (!known_sent(files, c->now_ms, list + (size_t)i * MSG_HASH))
            return false;
    return true;
}

typedef int limit_fn(const struct coord *c, const struct coord_conn *conn,
                     struct rad_error *err);

/* Would the request be more than its user may have?  Then the user is told. */
static bool
refused(struct coord *c, const struct coord_conn *conn, const struct msg *m,
        limit_fn *limit)
{
    struct rad_error err = { 0 };

    if (limit(c, conn, &err) == 0)
        return false;
    desk_reply_failed(c, conn, m->request, NULL, rad_exit_status(err.code),
                      err.what);
    return true;
}

static void
on_offer(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action_look l = { .conn = conn->id, .request = m->request };

    if (conn->offer_ms == 0 && refused(c, conn, m, quota_upload))
        return;
    if (!sort_offer(c, &conn->payer->files, &l, &m->offer)) {
        c->actions.failed = true;
        return;
    }
    if (conn->offer_ms == 0)
        conn->offer_ms = c->now_ms;
    conn->moved_ms = c->now_ms;
    if (!c->env.look || c->env.look(c->env.arg, &l))
        request_looked(c, conn, &l);
    else
        conn->answers++;
}

/* A piece of a file came; with the first the file is admitted, or refused.
 * False: the piece is not wanted.  Pieces that follow a refused one are dropped
 * without a word. */
static bool
admit_chunk(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    const struct msg_chunk *k = &m->chunk;
    struct rad_error err = { 0 };

    if (uploads_knows(&c->uploads, conn->id, k->hash))
        return true;
    if (k->offset != 0)
        return false;
    if (quota_file(c, conn, k->total, &err) != 0) {
        desk_reply_failed(c, conn, m->request, NULL, rad_exit_status(err.code),
                          err.what);
        return false;
    }
    if (uploads_begin(&c->uploads, conn->id, k->hash, k->total,
                      &conn->payer->uploads))
        return true;
    c->actions.failed = true;
    return false;
}

static void
on_chunk(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct action *a;

    conn->moved_ms = c->now_ms;
    if (!admit_chunk(c, conn, m))
        return;
    conn->sent_bytes += m->chunk.len;
    a = actions_add(&c->actions, ACT_PUT_CHUNK, conn->id);
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

/* There is no such job; if it was forgotten, its owner and an admin are told
 * so. */
static void
reply_no_job(struct coord *c, struct coord_conn *conn, uint32_t request,
             const uint8_t *id)
{
    char hex[MSG_JOB_HEX], text[MSG_MAX_TEXT + 1] = "no such job";
    const struct saved_gone *g;

    msg_job_format(id, hex);
    g = coord_find_gone(c, hex);
    if (g && (conn->session == MSG_AT_COORD_ADMIN ||
              strcmp(conn->owner, g->owner) == 0))
        coord_gone_text(g, text);
    desk_reply_failed(c, conn, request, id, EX_NOINPUT, text);
}

/* The job that a request names, if there is one and the sender may steer it, or
 * only `look` at it; else NULL, and the sender is told. */
static struct job *
find_job(struct coord *c, struct coord_conn *conn, uint32_t request,
         const uint8_t *id, bool look)
{
    struct job *job = desk_find_job(c, id);

    if (!job) {
        reply_no_job(c, conn, request, id);
        return NULL;
    }
    if (!may_steer(conn, job) &&
        !(look && conn->session == MSG_AT_COORD_OBSERVER)) {
        desk_reply_failed(c, conn, request, id, EX_NOPERM,
                          "the job belongs to another user");
        return NULL;
    }
    return job;
}

static struct job *
job_of_request(struct coord *c, struct coord_conn *conn, uint32_t request,
               const uint8_t *id)
{
    return find_job(c, conn, request, id, false);
}

/* Why a new job cannot be taken; 0: it can. */
static int
submit_fault(const struct coord *c, const struct coord_conn *conn,
             const struct msg_spec *spec, struct rad_error *err)
{
    struct partition_spec p;
    size_t active = 0;

    if (!spec->frames)
        return rad_fail(err, RAD_EPROTO, "a job without its list of frames");
    if (quota_priority(spec->priority, err) != 0 ||
        quota_job(c, conn, spec, err) != 0)
        return err->code;
    for (size_t i = 0; i < c->njobs; i++)
        active += !job_over(c->jobs[i]);
    if (active >= MOST_JOBS)
        return rad_fail(err, RAD_ETEMPFAIL, "the queue is full");
    if (job_partition_spec(spec, &p, err) != 0)
        return err->code;
    return partition_check(&p, err);
}

/* Are these the job's?  One that is as fine as another's from the start has
 * those of that one. */
static bool
has_options(const struct job *job, const struct msg_spec *spec)
{
    return strcmp(job->spec.params, spec->params) == 0 ||
           (goal_is(job) && job->spec.reuse);
}

/* Somebody submits a job that is here already: attach to it, if it is that. */
static void
attach(struct coord *c, struct coord_conn *conn, uint32_t request,
       const struct msg_spec *spec)
{
    struct job *job = job_of_request(c, conn, request, spec->job);

    if (!job)
        return;
    if (memcmp(job->spec.manifest, spec->manifest, MSG_HASH) != 0 ||
        !has_options(job, spec)) {
        desk_reply_failed(c, conn, request, job->id, EX_DATAERR,
                          "there is a job of that id, with other files or "
                          "options");
        return;
    }
    conn->watch_request = request;
    if (job->stage == STAGE_OPEN || job_over(job))
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

/* The job whose cache this one begins with is found now, for good: after a
 * restart it is the same. */
static int
choose_reuse(const struct coord *c, const struct coord_conn *conn,
             struct msg_spec *spec, char options[RAD_PARAMS_TEXT],
             struct rad_error *err)
{
    const struct job *from;

    if (!(spec->flags & MSG_JOB_REUSE))
        return 0;
    from = reuse_find(c, conn->owner, spec, err);
    if (err->code)
        return err->code;
    spec->reuse = from ? from->id : NULL;
    if (!from) {
        spec->flags &= ~MSG_JOB_REUSE;
        return 0;
    }
    if (msg_has_goal(spec)) {
        reuse_options(from, spec, options);
        spec->params = options;
    }
    return 0;
}

static void
on_submit(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct rad_error err = { 0 };
    struct msg_spec spec = m->submit;
    char options[RAD_PARAMS_TEXT];
    char name[200]; /* for the log */
    struct job *job;

    if (desk_find_job(c, m->submit.job)) {
        attach(c, conn, m->request, &m->submit);
        return;
    }
    if (submit_fault(c, conn, &spec, &err) != 0 ||
        choose_reuse(c, conn, &spec, options, &err) != 0) {
        desk_reply_failed(c, conn, m->request, m->submit.job,
                          rad_exit_status(err.code), err.what);
        return;
    }
    job = job_new(&spec, conn->owner);
    if (!job || !coord_add_job(c, job)) {
        job_free(job);
        c->actions.failed = true;
        return;
    }
    choose_coding(job);
    uploads_named(&c->uploads, &conn->payer->uploads, &job->spec.files);
    job->submit_ms = job->found_ms = c->now_ms;
    job->offer_ms = conn->offer_ms ? conn->offer_ms : c->now_ms;
    job->sent_bytes = conn->sent_bytes;
    conn->offer_ms = conn->sent_bytes = 0;
    conn->watch = job;
    conn->watch_request = m->request;
    rad_text_print(name, sizeof name, "%s", job->spec.name);
    actions_log(&c->actions, ACT_INFO, "job new job=%s owner=%s name=%s",
                job->hex, job->owner, name);
    coord_try_open(c, job);
}

/* The job that a request is to steer; NULL, and the user is told why: one that
 * is over neither goes on nor loses its picture. */
static struct job *
job_to_steer(struct coord *c, struct coord_conn *conn, uint32_t request,
             const uint8_t *id)
{
    struct job *job = job_of_request(c, conn, request, id);

    if (!job || !job_over(job))
        return job;
    desk_reply_failed(c, conn, request, job->id, EX_USAGE, "the job is over");
    return NULL;
}

/* The log says who steered which job. */
static void
log_job(struct coord *c, const struct coord_conn *conn, const char *what,
        const struct job *job)
{
    actions_log(&c->actions, ACT_INFO, "job %s job=%s by=%s", what, job->hex,
                conn->owner);
}

static void
log_worker(struct coord *c, const struct coord_conn *conn, const char *what,
           const struct coord_worker *w)
{
    actions_log(&c->actions, ACT_INFO, "worker %s name=%s by=%s", what, w->name,
                conn->owner);
}

static void
on_cancel(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_to_steer(c, conn, m->request, m->cancel.job);

    if (!job)
        return;
    log_job(c, conn, "cancelled", job);
    verdict_job(c, job, JOB_CANCELLED, EX_TEMPFAIL, "cancelled");
    coord_end_jobs(c); /* the answer waits until the store keeps this end */
    reply_settled(c, conn, m->request);
}

static void
on_pause(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_to_steer(c, conn, m->request, m->pause.job);

    if (!job)
        return;
    log_job(c, conn, "paused", job);
    job->state = JOB_PAUSED;
    coord_keep_state(c, job);
    reply_settled(c, conn, m->request);
}

static void
on_resume(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_to_steer(c, conn, m->request, m->resume.job);

    if (!job)
        return;
    log_job(c, conn, "resumed", job);
    if (job->state == JOB_PAUSED)
        job->state = job->first_ms ? JOB_RUNNING : JOB_WAITING;
    coord_keep_state(c, job);
    reply_settled(c, conn, m->request);
}

static void
on_delete(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    struct job *job = job_of_request(c, conn, m->request, m->delete.job);

    if (!job)
        return;
    if (!job_over(job)) {
        desk_reply_failed(c, conn, m->request, job->id, EX_USAGE,
                          "the job is not over: cancel it first");
        return;
    }
    log_job(c, conn, "deleted", job);
    coord_forget_job(c, job, GONE_DELETED);
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
    coord_set_priority(c, job, m->priority.priority);
    actions_log(&c->actions, ACT_INFO, "job priority job=%s priority=%d by=%s",
                job->hex, m->priority.priority, conn->owner);
    coord_keep_state(c, job);
    reply_settled(c, conn, m->request);
}

/* Bytes at to end of a text, as CHUNKs. */
static void
send_text(struct coord *c, const struct coord_conn *conn, uint32_t request,
          const char *text, size_t total, size_t at, size_t end)
{
    for (; at < end; at += MSG_MAX_CHUNK) {
        size_t n = end - at < MSG_MAX_CHUNK ? end - at : MSG_MAX_CHUNK;
        struct msg m = { .type = MSG_CHUNK,
                         .request = request,
                         .chunk = { NULL, at, total, (const uint8_t *)text + at,
                                    n } };

        actions_send(&c->actions, conn->id, &m);
    }
}

/* The job whose statistics are told; NULL: it was deleted, and its id may be
 * another's now. */
static const struct job *
told_of(const struct coord *c, const struct coord_telling *t)
{
    const struct job *job = desk_find_job(c, t->job);

    return job && job->sequence == t->sequence ? job : NULL;
}

/* Send the next bytes of statistics that are whole; false: all are sent. */
static bool
send_more(struct coord *c, const struct coord_conn *conn,
          struct coord_telling *t)
{
    size_t end = t->len - t->sent < TELL_BYTES ? t->len : t->sent + TELL_BYTES;

    send_text(c, conn, t->request, t->whole, t->len, t->sent, end);
    t->sent = end;
    return end < t->len;
}

/* The next piece; false: there is none any more. */
static bool
tell_more(struct coord *c, struct coord_conn *conn, struct coord_telling *t)
{
    const struct job *job = told_of(c, t);
    int rc;

    if (t->whole)
        return send_more(c, conn, t);
    if (!job) {
        desk_reply_failed(c, conn, t->request, t->job, EX_NOINPUT,
                          "no such job");
        return false;
    }
    rc = stats_more(t->text, job, STATS_PIECE);
    c->actions.failed |= rc < 0;
    if (rc != 1)
        return rc == 0;
    t->whole = stats_take(t->text);
    t->text = NULL;
    t->len = strlen(t->whole);
    return send_more(c, conn, t);
}

/* Statistics of few units are answered at once, those of many piece by piece.
 */
static void
fetch_stats(struct coord *c, struct coord_conn *conn, const struct msg *m,
            const struct job *job)
{
    struct coord_telling *t = calloc(1, sizeof *t), **at = &conn->telling;

    if (t)
        t->text = stats_begin(job, c->now_ms);
    if (!t || !t->text) {
        free(t);
        c->actions.failed = true;
        return;
    }
    memcpy(t->job, job->id, MSG_JOB);
    t->sequence = job->sequence;
    t->request = m->request;
    while (*at)
        at = &(*at)->next;
    *at = t;
    conn->answers++;
    if (at == &conn->telling && !tell_more(c, conn, t))
        telling_drop(conn, at);
}

/* Make or send one piece for each connection that waits. */
static void
tell_all(struct coord *c)
{
    for (struct coord_conn *conn = c->conns; conn; conn = conn->next)
        if (conn->telling && !tell_more(c, conn, conn->telling))
            telling_drop(conn, &conn->telling);
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
    if (m->what != MSG_WHAT_DEPTH && job->spec.flags & MSG_JOB_POINTS)
        return "the job is of sensor points: radsubmit --job writes "
               "their values";
    *status = EX_TEMPFAIL;
    if (m->what == MSG_WHAT_PREVIEW)
        return job->pixels_done > 0 || job->frames[m->frame].shown ||
                       frame_is_written(&job->frames[m->frame])
                   ? NULL
                   : "nothing is rendered yet";
    if (frame_is_written(&job->frames[m->frame]))
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
    struct job *job = find_job(c, conn, m->request, m->fetch.job, true);
    const char *fault;
    struct action *a;
    int status;

    if (!job)
        return;
    if (m->fetch.what == MSG_WHAT_STATS && job->stage != STAGE_FILED) {
        fetch_stats(c, conn, m, job);
        return;
    }
    job->watched |= m->fetch.what == MSG_WHAT_PREVIEW;
    fault = fetch_fault(job, &m->fetch, &status);
    if (fault) {
        desk_reply_failed(c, conn, m->request, job->id, status, fault);
        return;
    }
    a = actions_add_job(&c->actions, ACT_SEND_PICTURE, conn->id, job->id);
    if (!a)
        return;
    a->request = m->request;
    a->frame = m->fetch.frame;
    a->what = m->fetch.what;
    conn->answers++;
}

/* The limits, and how much of each a user has: the asker, or for an admin any
 * user. */
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

/* --- workers, by an admin --- */

/* The worker stays drained, after a restart too, until an admin says otherwise.
 */
static void
keep_drained(struct coord *c, const struct coord_worker *w)
{
    struct action *a =
        c->env.keeps ? actions_add(&c->actions, ACT_DRAINED, 0) : NULL;

    if (!a)
        return;
    a->status = w->drained;
    a->text = rad_arena_strndup(&c->actions.mem, w->name, strlen(w->name));
    if (!a->text)
        c->actions.failed = true;
}

/* The worker of that name; NULL: there is none, and the sender is told. */
static struct coord_worker *
worker_of_request(struct coord *c, struct coord_conn *conn, uint32_t request,
                  const char *name)
{
    struct coord_worker *w = c->workers;
    char text[MSG_MAX_TEXT + 1];

    while (w && (w->forgotten || strcmp(w->name, name) != 0))
        w = w->next;
    if (!w) {
        snprintf(text, sizeof text, "no worker '%s'", name);
        desk_reply_failed(c, conn, request, NULL, EX_NOINPUT, text);
    }
    return w;
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
    coord_drop_forgotten(c);
    reply_settled(c, conn, m->request);
}

/* --- keys, by an admin --- */

/* Keys are the shell's: it has the key file. */
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
    a->text =
        rad_arena_strndup(&c->actions.mem, conn->owner, strlen(conn->owner));
    if (!a->key.name || !a->text)
        c->actions.failed = true;
}

/* Answers that wait for the disk are limited in number. */
static const struct {
    enum msg_type type;
    void (*handle)(struct coord *c, struct coord_conn *conn,
                   const struct msg *m);
    bool waits;
} handlers[] = {
    { MSG_OFFER, on_offer, true },    { MSG_CHUNK, on_chunk, false },
    { MSG_SUBMIT, on_submit, false }, { MSG_CANCEL, on_cancel, true },
    { MSG_PAUSE, on_pause, true },    { MSG_RESUME, on_resume, true },
    { MSG_FETCH, on_fetch, true },    { MSG_QUERY, on_query, false },
    { MSG_DRAIN, on_drain, false },   { MSG_UNDRAIN, on_undrain, false },
    { MSG_KEY, on_key, false },       { MSG_PRIORITY, on_priority, true },
    { MSG_PAGE, on_page, false },     { MSG_DELETE, on_delete, true },
    { MSG_FORGET, on_forget, false },
};

void
request_handle(struct coord *c, struct coord_conn *conn, const struct msg *m)
{
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++)
        if (handlers[i].type == m->type) {
            if (!handlers[i].waits || !refused(c, conn, m, quota_answer))
                handlers[i].handle(c, conn, m);
            return;
        }
}
