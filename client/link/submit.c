/* submit.c - see submit.h
 *
 * There is one function for each step, which waits for its answer; all other
 * messages that come meanwhile go through take().  After a step that fails with
 * RAD_EUNAVAIL the whole conversation begins again on a new connection: every
 * step may be repeated. */
#include "config.h"

#include "link/submit.h"

#include "link/fetch.h"
#include "link/roll.h"
#include "common/figure.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CONNECT_MS = 5000,
    CONNECT_LEAST_MS = 1000, /* least time to connect, even if --wait is less */
    BACKOFF_MS = 500,
    BACKOFF_MAX_MS = 30000,
    COME_MS = 10,          /* how often to ask for workers that are to come, */
    COME_SLOWLY_MS = 2000, /* for so long; then at a tenth of this */
    LOOK_MS = 500,         /* longest wait for a message before other checks */
    PREVIEW_MS = 1000,     /* least time between previews, */
    PREVIEW_SHARE = 10,    /* plus the time that one takes, so many times */
    REASON_MS = 10000,     /* least time between questions for a reason */
    CANCEL_MS = 5000       /* longest wait for a job to be cancelled */
};

/* What the coordinator has of the job, as far as we know.  A later connection
 * does not set this back.
 *
 *   OURS --SUBMIT--> ASKED --PROGRESS with its id--> KNOWN --ACCEPT--> ACCEPTED
 *                      '------------------ACCEPT-----------------------^ */
enum stage {
    STAGE_OURS,  /* nothing, or only files */
    STAGE_ASKED, /* SUBMIT was sent, so it may have the job */
    STAGE_KNOWN, /* it has the job, which waits for room on the disk */
    STAGE_ACCEPTED
};

struct submit {
    const struct submit_job *job;
    const struct submit_callbacks *cb;
    struct link_where where;
    struct link *link;
    struct rad_error *err;
    uint32_t request;  /* number of our last request */
    uint64_t start_ms; /* when we began; later, when the job was accepted */
    uint64_t wait_ms;  /* since when a worker could have come; 0: not yet */
    bool connected;    /* there was a connection at some time */
    enum stage stage;
    bool met_worker, done, cancelled;
    bool fetching;      /* fetch() or ask() handles a FAILED of this request */
    bool over;          /* the job has failed, or is cancelled */
    bool ended;         /* our own cluster has ended: do not try again */
    uint32_t delivered; /* frames that were delivered */
    struct msg_progress last; /* without its job id */
    uint64_t preview_due_ms;
    uint64_t reason_due_ms; /* when to ask again why no worker is at the job */
};

static uint64_t
now_ms(const struct submit *s)
{
    uv_update_time(s->where.loop);
    return uv_now(s->where.loop);
}

/* How the user gets the job's results.  Values of sensor points are useless
 * without the points, so those need the same submission again. */
static void
format_way(const struct submit *s, char *buf, size_t n)
{
    uint32_t flags = s->job->spec->flags;
    char hex[MSG_JOB_HEX];

    msg_job_format(s->job->spec->job, hex);
    if (!(flags & MSG_JOB_POINTS))
        snprintf(buf, n, "radctl fetch %s%s -o FILE%s", hex,
                 strstr(s->job->spec->params, "--plane")
                     ? " and the ids of the other planes"
                     : "",
                 s->job->spec->nframes > 1 ? "%d" : "");
    else
        snprintf(buf, n, "submit again with --job=%s", hex);
}

/* An error that says that the job, or what it made, stays with the coordinator,
 * and what to do. */
static int
left_behind(struct submit *s)
{
    char hex[MSG_JOB_HEX], way[160];

    msg_job_format(s->job->spec->job, hex);
    format_way(s, way, sizeof way);
    if (s->done)
        return rad_fail(s->err, RAD_ETEMPFAIL,
                        "interrupted; the job is done: %s", way);
    if (s->last.state == MSG_STATE_PAUSED)
        return rad_fail(s->err, RAD_ETEMPFAIL,
                        "interrupted; the job stays, paused: radctl resume %s, "
                        "then %s",
                        hex, way);
    if (s->last.state == MSG_STATE_HELD)
        return rad_fail(s->err, RAD_ETEMPFAIL,
                        "interrupted; the job stays, and goes on when the "
                        "coordinator's disk has room: %s",
                        way);
    return rad_fail(s->err, RAD_ETEMPFAIL, "interrupted; the job goes on: %s",
                    way);
}

static int
interrupted(struct submit *s)
{
    char hex[MSG_JOB_HEX];

    if ((s->cancelled && !s->done) || s->cb->alive || s->stage < STAGE_ASKED)
        return rad_fail(s->err, RAD_ETEMPFAIL, "interrupted");
    if (s->stage >= STAGE_KNOWN)
        return left_behind(s);
    msg_job_format(s->job->spec->job, hex);
    return rad_fail(s->err, RAD_ETEMPFAIL,
                    "interrupted; the coordinator may have the job: radctl "
                    "job %s",
                    hex);
}

static bool
is_ours(const struct submit *s, const uint8_t *job)
{
    static const uint8_t none[MSG_JOB];

    return memcmp(job, s->job->spec->job, MSG_JOB) == 0 ||
           memcmp(job, none, MSG_JOB) == 0;
}

/* Note that the job has reached a stage, at least.  From STAGE_KNOWN on its id
 * means something to the coordinator, and the caller is told. */
static void
reach(struct submit *s, enum stage to)
{
    if (to >= STAGE_KNOWN && s->stage < STAGE_KNOWN && s->cb->accepted)
        s->cb->accepted(s->cb->arg);
    if (s->stage < to)
        s->stage = to;
}

/* --- messages that may come at any time --- */

static int
take(struct submit *s, const struct msg *m)
{
    switch (m->type) {
    case MSG_PROGRESS:
        if (!is_ours(s, m->progress.job))
            return 0;
        s->last = m->progress;
        if (memcmp(m->progress.job, s->job->spec->job, MSG_JOB) == 0)
            reach(s, STAGE_KNOWN);
        /* it may have begun and left between two reports */
        if (m->progress.workers > 0 || m->progress.state == MSG_STATE_RUNNING)
            s->met_worker = true;
        if (s->wait_ms == 0 || m->progress.state == MSG_STATE_HELD ||
            m->progress.state == MSG_STATE_PAUSED)
            s->wait_ms = now_ms(s); /* no worker can come meanwhile */
        if (s->cb->progress)
            s->cb->progress(s->cb->arg, &m->progress);
        return 0;
    case MSG_RECORDS:
        if (s->cb->records && is_ours(s, m->records.job))
            s->cb->records(s->cb->arg, &m->records);
        return 0;
    case MSG_DONE:
        s->done |= is_ours(s, m->done.job);
        return 0;
    case MSG_FAILED:
        if (!is_ours(s, m->failed.job) ||
            (s->fetching && m->request == s->request) ||
            (s->cancelled && s->done)) /* it ended before CANCEL came */
            return 0;
        s->over = true;
        if (s->cancelled)
            return interrupted(s);
        return rad_fail(s->err, link_code(m->failed.status), "%s",
                        m->failed.text);
    default:
        return 0;
    }
}

static int cancel(struct submit *s);

/* Wait at most ms for the next message.  Returns 1 and *m, which take() has
 * handled; 0; or an error.  An interrupt is an error unless it is the first and
 * the job is known, for then the caller has to cancel. */
static int
next(struct submit *s, int ms, const struct msg **m)
{
    int rc;

    if (*s->where.wake > (s->stage >= STAGE_KNOWN ? 1 : 0))
        return interrupted(s);
    rc = link_recv(s->link, ms, m, s->err);
    if (rc == 1) {
        int taken = take(s, *m);

        if (taken < 0)
            return taken;
    }
    return rc;
}

/* Wait for a message of that type. */
static int
await(struct submit *s, uint16_t type, const struct msg **m)
{
    int rc;

    do {
        /* the job waits for room, so the first interrupt cancels it here */
        if (*s->where.wake == 1 && s->stage == STAGE_KNOWN)
            return cancel(s);
        rc = next(s, LOOK_MS, m);
    } while (rc == 0 || (rc == 1 && (*m)->type != type));
    return rc < 0 ? rc : 0;
}

/* --- sending the scene --- */

static int
send_file(struct submit *s, const uint8_t hash[MSG_HASH])
{
    struct msg m = { .type = MSG_CHUNK };
    unsigned char *bytes;
    size_t len;
    uint64_t at = 0;
    int rc = cargo_read(s->job->cargo, hash, &bytes, &len, s->err);

    if (rc < 0)
        return rc;
    do {
        m.chunk.hash = hash;
        m.chunk.offset = at;
        m.chunk.total = len;
        m.chunk.data = bytes + at;
        m.chunk.len = len - at < MSG_MAX_CHUNK ? len - at : MSG_MAX_CHUNK;
        rc = link_send(s->link, &m, s->err);
        at += m.chunk.len;
        if (rc == 0 && *s->where.wake > 0)
            rc = interrupted(s);
    } while (rc == 0 && at < len);
    free(bytes);
    return rc;
}

/* Offer all files, send those that are wanted, and wait until they are stored.
 */
static int
send_scene(struct submit *s)
{
    struct msg offer = { .type = MSG_OFFER, .request = ++s->request };
    const struct msg *m;
    uint8_t *wanted;
    uint32_t n;
    int rc;

    offer.offer.n = s->job->cargo->n;
    offer.offer.hash = s->job->cargo->hashes;
    if ((rc = link_send(s->link, &offer, s->err)) < 0 ||
        (rc = await(s, MSG_WANT, &m)) < 0)
        return rc;
    n = m->want.n;
    wanted = malloc((size_t)n * MSG_HASH + 1);
    if (!wanted)
        return rad_fail_memory(s->err);
    memcpy(wanted, m->want.hash, (size_t)n * MSG_HASH);
    for (uint32_t i = 0; i < n && rc == 0; i++)
        rc = send_file(s, wanted + (size_t)i * MSG_HASH);
    for (uint32_t i = 0; i < n && rc == 0; i++)
        rc = await(s, MSG_HAVE, &m);
    free(wanted);
    return rc;
}

static void
tell_reuse(const struct submit *s, const struct msg_accept *a)
{
    static const uint8_t none[MSG_JOB];

    s->cb->reuse(s->cb->arg,
                 memcmp(a->reuse, none, MSG_JOB) == 0 ? NULL : a->reuse);
}

static int
send_job(struct submit *s)
{
    struct msg m = { .type = MSG_SUBMIT, .request = ++s->request };
    const struct msg *answer;
    int rc;

    m.submit = *s->job->spec;
    reach(s, STAGE_ASKED);
    if ((rc = link_send(s->link, &m, s->err)) < 0 ||
        (rc = await(s, MSG_ACCEPT, &answer)) < 0)
        return rc;
    if (s->stage == STAGE_ACCEPTED)
        return 0;
    reach(s, STAGE_ACCEPTED);
    s->start_ms = now_ms(s);
    if (s->cb->reuse)
        tell_reuse(s, &answer->accept);
    return 0;
}

/* --- getting pictures --- */

/* Get a file of the job.  The caller frees f->bytes whatever is returned. */
static int
fetch(struct submit *s, uint32_t frame, enum msg_what what,
      struct rad_memory_out *f)
{
    const struct msg *m;
    int rc;

    *f = (struct rad_memory_out){ 0 };
    s->fetching = true;
    rc = fetch_start(s->link, s->job->spec->job, frame, what, ++s->request,
                     s->err);
    while (rc == 0) {
        rc = next(s, LOOK_MS, &m);
        if (rc == 1)
            rc = m->request == s->request ? fetch_take(f, m, s->err) : 0;
    }
    s->fetching = false;
    return rc < 0 ? rc : 0;
}

static int
deliver_frame(struct submit *s)
{
    struct rad_memory_out picture = { 0 }, depth = { 0 };
    bool wanted = s->job->spec->flags & MSG_JOB_DEPTH;
    int rc = 0;

    if (!(s->job->spec->flags & MSG_JOB_POINTS))
        rc = fetch(s, s->delivered, MSG_WHAT_PICTURE, &picture);
    if (rc == 0 && wanted)
        rc = fetch(s, s->delivered, MSG_WHAT_DEPTH, &depth);
    if (rc == 0)
        rc = s->cb->frame(s->cb->arg, s->delivered, picture.bytes, picture.len,
                          wanted ? depth.bytes : NULL, depth.len, s->err);
    free(picture.bytes);
    free(depth.bytes);
    if (rc == 0)
        s->delivered++;
    return rc;
}

/* Returns 1; or 0 if there is no preview, which does no harm; or an error. */
static int
fetch_preview(struct submit *s, struct rad_memory_out *f)
{
    struct rad_error *err = s->err;
    struct rad_error why = { 0 };
    int rc;

    s->err = &why;
    rc = fetch(s, s->delivered, MSG_WHAT_PREVIEW, f);
    s->err = err;
    if (rc == 0 || (!s->over && rc != RAD_EUNAVAIL && rc != RAD_EPROTO))
        return rc < 0 ? 0 : 1;
    if (err)
        *err = why;
    return rc;
}

/* Get a preview if it is due.  From the first request on the coordinator has
 * workers send colours for it before their rows come. */
static int
preview(struct submit *s)
{
    uint64_t begin = now_ms(s), end;
    struct rad_memory_out f;
    int rc;

    if (!s->cb->preview || begin < s->preview_due_ms)
        return 0;
    rc = fetch_preview(s, &f);
    if (rc == 1)
        rc = s->cb->preview(s->cb->arg, f.bytes, f.len, s->err);
    free(f.bytes);
    end = now_ms(s);
    s->preview_due_ms = end + PREVIEW_MS + PREVIEW_SHARE * (end - begin);
    return rc;
}

/* Ask the coordinator about the cluster.  *answer is NULL if it refuses, or if
 * the job has ended meanwhile. */
static int
ask(struct submit *s, struct msg *m, const struct msg_answer **answer)
{
    const struct msg *got;
    int rc;

    *answer = NULL;
    m->request = ++s->request;
    s->fetching = true; /* so that a refusal does not end the job */
    rc = link_send(s->link, m, s->err);
    do
        rc = rc < 0 ? rc : next(s, LOOK_MS, &got);
    while (rc == 0 || (rc == 1 && got->request != s->request && !s->done));
    s->fetching = false;
    if (rc == 1 && got->request == s->request && got->type == MSG_ANSWER)
        *answer = &got->answer;
    return rc < 0 ? rc : 0;
}

/* Ask for the job's row and tell its text, as radctl jobs shows it. */
static int
ask_reason(struct submit *s)
{
    char hex[MSG_JOB_HEX];
    struct msg m = { .type = MSG_QUERY, .query = { MSG_QUERY_JOB, hex } };
    const struct msg_answer *answer;
    const char *text;
    json_t *row;
    int rc;

    msg_job_format(s->job->spec->job, hex);
    rc = ask(s, &m, &answer);
    if (rc < 0 || !answer)
        return rc;
    row = json_loadb((const char *)answer->text, answer->len, 0, NULL);
    text = json_string_value(json_object_get(row, "text"));
    s->cb->reason(s->cb->arg, text ? text : "");
    json_decref(row);
    return 0;
}

/* If no worker is at the job, ask the coordinator for the reason. */
static int
reason(struct submit *s)
{
    if (!s->cb->reason || s->done || s->cancelled ||
        !s->cb->wonders(s->cb->arg) || now_ms(s) < s->reason_due_ms)
        return 0;
    s->reason_due_ms = now_ms(s) + REASON_MS;
    return ask_reason(s);
}

static int
deliver_stats(struct submit *s)
{
    struct rad_memory_out f;
    int rc;

    if (!s->cb->stats)
        return 0;
    rc = fetch(s, 0, MSG_WHAT_STATS, &f);
    if (rc == 0)
        rc = s->cb->stats(s->cb->arg, f.bytes, f.len, s->err);
    free(f.bytes);
    return rc;
}

/* --- workers at the coordinator --- */

/* Ask for all workers, page by page; r is empty if the job has ended meanwhile.
 */
static int
ask_workers(struct submit *s, struct roll *r)
{
    struct msg_page all = { .what = MSG_ROWS_WORKERS, .user = "", .state = "" };
    struct msg m = { .type = MSG_PAGE, .page = all };
    const struct msg_answer *answer;
    uint64_t next;
    int rc;

    *r = (struct roll){ 0 };
    for (;; m.page.cursor = next) {
        if ((rc = ask(s, &m, &answer)) < 0 || s->done)
            return rc;
        if ((rc = roll_page(r, answer, &next, s->err)) < 0)
            return rc;
        if (next <= m.page.cursor)
            return 0;
    }
}

/* --- while it renders --- */

static void
say_what_it_got(struct submit *s)
{
    const struct msg_progress *p = &s->last;
    uint32_t nframes = s->job->spec->nframes;
    char text[200], seconds[FIGURE_TEXT], written[60] = "no picture is written";

    if (!s->met_worker) {
        s->cb->say(s->cb->arg, "cancelled: nothing was rendered yet");
        return;
    }
    if (nframes > 1)
        snprintf(written, sizeof written,
                 "%" PRIu32 " of %" PRIu32 " pictures are written",
                 s->delivered, nframes);
    snprintf(text, sizeof text,
             "cancelled: %.0f %% of the pixels were rendered in %s s; %s",
             p->pixels_total ? floor(100. * (double)p->pixels_done /
                                     (double)p->pixels_total)
                             : 0,
             figure(seconds, p->elapsed_s, 3), written);
    s->cb->say(s->cb->arg, text);
}

/* Is the job over, or the cluster that has it going to be? */
static bool
is_settled(const struct submit *s)
{
    return s->over || s->done || s->cb->alive;
}

/* CANCEL may have come too late, or never. */
static int
not_settled(struct submit *s)
{
    char hex[MSG_JOB_HEX];

    msg_job_format(s->job->spec->job, hex);
    *s->err = (struct rad_error){ 0 }; /* why the connection failed */
    return rad_fail(s->err, RAD_ETEMPFAIL,
                    "the coordinator has not said that the job is cancelled: "
                    "radctl cancel %s",
                    hex);
}

/* Cancel the job and wait, for CANCEL_MS at most, until the coordinator has, or
 * says that the job is over.  A job that was done before CANCEL came stays. */
static int
cancel(struct submit *s)
{
    struct msg m = { .type = MSG_CANCEL, .request = ++s->request };
    const struct msg *answer;
    uint64_t until = now_ms(s) + CANCEL_MS;
    int rc;

    s->cancelled = true;
    m.cancel.job = s->job->spec->job;
    rc = link_send(s->link, &m, s->err);
    while (rc >= 0 && now_ms(s) < until) {
        rc = next(s, LOOK_MS, &answer);
        if (rc == 1 && answer->request == s->request &&
            (answer->type == MSG_ANSWER || answer->type == MSG_FAILED)) {
            s->over = true;
            break;
        }
    }
    if (!is_settled(s))
        return not_settled(s);
    if (!s->done || s->cb->alive)
        say_what_it_got(s);
    return interrupted(s);
}

static int
no_worker(struct submit *s)
{
    struct rad_error *err = s->err;
    struct rad_error why = { 0 };

    s->err = &why;
    cancel(s);
    s->err = err;
    if (!is_settled(s))
        return rad_fail(err, RAD_EUNAVAIL, "no worker came in %g s; %s",
                        s->job->wait_s, why.what);
    return rad_fail(err, RAD_EUNAVAIL, "no worker came in %g s%s",
                    s->job->wait_s,
                    s->cb->alive ? "" /* the workers are our own */
                                 : ": --wait=S waits longer, --detach leaves "
                                   "the job to the coordinator");
}

static bool
waited_since(struct submit *s, uint64_t ms)
{
    return (double)(now_ms(s) - ms) >= 1000 * s->job->wait_s;
}

/* Is --wait over, for a coordinator or for workers of our own? */
static bool
waited(struct submit *s)
{
    return waited_since(s, s->start_ms);
}

/* Is --wait over without a worker, counted from when the job could have one? */
static bool
waited_for_worker(struct submit *s)
{
    return !s->met_worker && s->wait_ms > 0 && waited_since(s, s->wait_ms);
}

/* --wait is over.  If workers are at other jobs ours is only in the queue,
 * which may take any time: --wait begins anew. */
static int
in_queue(struct submit *s, bool *queued)
{
    struct roll r;
    int rc = ask_workers(s, &r);

    *queued = s->done || r.busy;
    s->wait_ms = now_ms(s);
    return rc;
}

/* Check that our own cluster, if there is one, still runs. */
static int
alive(struct submit *s)
{
    int rc = s->cb->alive ? s->cb->alive(s->cb->arg, s->err) : 0;

    s->ended |= rc < 0;
    return rc;
}

/* Get pictures until the last has come. */
static int
watch(struct submit *s)
{
    const struct msg *m;
    bool queued;
    int rc;

    while (s->delivered < s->job->spec->nframes) {
        if (*s->where.wake == 1)
            return cancel(s);
        if (s->done || s->last.frames_ready > s->delivered) {
            if ((rc = deliver_frame(s)) < 0)
                return rc;
            continue;
        }
        if (waited_for_worker(s)) {
            if ((rc = in_queue(s, &queued)) < 0)
                return rc;
            if (!queued)
                return no_worker(s);
        }
        if ((rc = preview(s)) < 0)
            return rc;
        if ((rc = next(s, LOOK_MS, &m)) < 0 || (rc = reason(s)) < 0)
            return rc;
        if (rc == 0 && (rc = alive(s)) < 0)
            return rc;
    }
    while (!s->done) /* the last picture may come before DONE */
        if ((rc = next(s, LOOK_MS, &m)) < 0)
            return rc;
    return deliver_stats(s);
}

/* --- connecting again --- */

static void
on_pause_over(uv_timer_t *t)
{
    *(bool *)t->data = true;
    uv_stop(t->loop); /* or a pause of 0 ms would wait for another event */
}

static void
on_pause_closed(uv_handle_t *h)
{
    h->data = NULL;
}

/* Wait ms, or until an interrupt comes. */
static void
pause_for(struct submit *s, uint64_t ms)
{
    uv_timer_t timer;
    bool over = false;
    int wake = *s->where.wake;

    uv_timer_init(s->where.loop, &timer);
    timer.data = &over;
    uv_update_time(s->where.loop);
    uv_timer_start(&timer, on_pause_over, ms, 0);
    while (!over && *s->where.wake == wake)
        uv_run(s->where.loop, UV_RUN_ONCE);
    uv_close((uv_handle_t *)&timer, on_pause_closed);
    while (timer.data)
        uv_run(s->where.loop, UV_RUN_ONCE);
}

/* --- launched workers --- */

/* Wait until all launched workers have come, or --wait is over. */
static int
await_workers(struct submit *s)
{
    uint64_t pause_ms = COME_MS, begin_ms = now_ms(s);
    struct roll r;
    int rc;

    if (!s->cb->gathered || s->stage == STAGE_ACCEPTED)
        return 0;
    while ((rc = ask_workers(s, &r)) == 0) {
        rc = s->cb->gathered(s->cb->arg, r.n, r.names, s->err);
        s->ended |= rc < 0;
        if (rc != 0)
            break;
        if (now_ms(s) - begin_ms > COME_SLOWLY_MS)
            pause_ms = COME_SLOWLY_MS / 10;
        pause_for(s, pause_ms);
    }
    return rc < 0 ? rc : 0;
}

static int
converse(struct submit *s)
{
    int rc;

    s->done = false;
    s->last.frames_ready = 0;
    if ((rc = send_scene(s)) < 0 || (rc = await_workers(s)) < 0 ||
        (rc = send_job(s)) < 0 || s->job->detach)
        return rc;
    return watch(s);
}

/* --- trying again --- */

/* Returns 0 if trying again makes sense. */
static int
may_retry(struct submit *s, const struct rad_error *why)
{
    int rc;

    if (*s->where.wake > 0)
        return interrupted(s);
    if ((rc = alive(s)) < 0)
        return rc;
    if (s->stage < STAGE_ACCEPTED && waited(s))
        return rad_fail(s->err, RAD_EUNAVAIL, "%s", why->what);
    return 0;
}

/* The lesser of ms and the rest of --wait's time, rounded up. */
static uint64_t
within_wait(struct submit *s, uint64_t ms)
{
    double left = 1000 * s->job->wait_s - (double)(now_ms(s) - s->start_ms);

    if (s->stage == STAGE_ACCEPTED || (double)ms <= left)
        return ms;
    return left > 0 ? (uint64_t)left + 1 : 0;
}

/* How long to wait before try n: twice as long each time, plus up to a quarter
 * at random, so that many clients do not dial at once; not beyond --wait. */
static uint64_t
backoff_ms(struct submit *s, int n)
{
    uint64_t ms = BACKOFF_MAX_MS, r;

    if (n < 6)
        ms = (uint64_t)BACKOFF_MS << n;
    if (uv_random(NULL, NULL, &r, sizeof r, 0, NULL) == 0)
        ms += r % (ms / 4);
    return within_wait(s, ms);
}

/* One connection, from dialling to its end. */
static int
attempt(struct submit *s, int *failures)
{
    uint64_t ms = within_wait(s, CONNECT_MS);
    int rc =
        link_open(&s->link, &s->where, &s->job->to, MSG_ROLE_USER,
                  (int)(ms > CONNECT_LEAST_MS ? ms : CONNECT_LEAST_MS), s->err);

    if (rc < 0)
        return rc;
    if (s->connected)
        s->cb->say(s->cb->arg, "connected again");
    s->connected = true;
    *failures = 0;
    rc = converse(s);
    link_close(s->link);
    s->link = NULL;
    return rc;
}

int
submit_run(const struct submit_job *job, uv_loop_t *loop, const int *interrupts,
           const struct submit_callbacks *cb, struct rad_error *err)
{
    struct submit s = { .job = job, .cb = cb };
    struct rad_error why;
    int rc, failures = 0;
    char text[sizeof why.what + 40];

    s.where = (struct link_where){ loop, interrupts };
    s.start_ms = now_ms(&s);
    for (;;) {
        why = (struct rad_error){ 0 };
        s.err = &why;
        rc = attempt(&s, &failures);
        s.err = err;
        if (rc != RAD_EUNAVAIL || s.cancelled || s.ended)
            break;
        if ((rc = may_retry(&s, &why)) < 0)
            return rc;
        if (failures == 0) {
            snprintf(text, sizeof text, "%s; trying again", why.what);
            cb->say(cb->arg, text);
        }
        pause_for(&s, backoff_ms(&s, failures++));
    }
    if (rc < 0 && err)
        *err = why;
    return rc;
}
