/* submit.c - see submit.h; submit_impl.h says which other files there are */
#include "config.h"

#include "link/submit_impl.h"

#include "common/figure.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CONNECT_MS = 5000,
    CONNECT_LEAST_MS = 1000, /* least time to connect, even if --wait is less */
    BACKOFF_MS = 500,
    BACKOFF_MAX_MS = 30000,
    BACKOFFS_IN_LINE = 3, /* pauses of one who waits for a turn grow so often */
    COME_MS = 2,          /* how often to ask for workers that are to come, */
    COME_SLOWLY_MS = 2000 /* for so long; then at a tenth of this */
};

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
            rc = submit_interrupted(s);
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
        (rc = submit_await(s, MSG_WANT, &m)) < 0)
        return rc;
    n = m->want.n;
    if (n < s->nwanted) /* the last try brought files */
        s->failures = 0;
    s->nwanted = n;
    wanted = malloc((size_t)n * MSG_HASH + 1);
    if (!wanted)
        return rad_fail_memory(s->err);
    memcpy(wanted, m->want.hash, (size_t)n * MSG_HASH);
    for (uint32_t i = 0; i < n && rc == 0; i++)
        rc = send_file(s, wanted + (size_t)i * MSG_HASH);
    for (uint32_t i = 0; i < n && rc == 0; i++)
        rc = submit_await(s, MSG_HAVE, &m);
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
    submit_reach(s, STAGE_ASKED);
    if ((rc = link_send(s->link, &m, s->err)) < 0 ||
        (rc = submit_await(s, MSG_ACCEPT, &answer)) < 0) {
        if (s->refusal != REFUSAL_NONE) {
            s->stage = STAGE_OURS;
            s->refusal = REFUSAL_IN_LINE;
        }
        return rc;
    }
    s->failures = 0;
    if (s->stage == STAGE_ACCEPTED)
        return 0;
    submit_reach(s, STAGE_ACCEPTED);
    if (s->cb->reuse)
        tell_reuse(s, &answer->accept);
    return 0;
}

/* --- while it renders --- */

static int
no_worker(struct submit *s)
{
    struct rad_error *err = s->err;
    struct rad_error why = { 0 };

    s->err = &why;
    submit_cancel(s);
    s->err = err;
    if (!submit_is_settled(s))
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
    return (double)(submit_now_ms(s) - ms) >= 1000 * s->job->wait_s;
}

/* Is --wait over without a worker, counted from when the job could have one? */
static bool
waited_for_worker(struct submit *s)
{
    return !s->met_worker && s->wait_ms > 0 && !submit_stands_still(s) &&
           waited_since(s, s->wait_ms);
}

/* --wait is over.  If workers are at other jobs ours is only in the queue,
 * which may take any time: --wait begins anew. */
static int
in_queue(struct submit *s, bool *queued)
{
    struct roll r;
    int rc = submit_ask_workers(s, &r);

    *queued = submit_is_done(s) || r.busy;
    s->wait_ms = submit_now_ms(s);
    return rc;
}

/* Check that our own cluster, if there is one, still runs. */
static int
alive(struct submit *s)
{
    int rc = s->cb->alive ? s->cb->alive(s->cb->arg, s->err) : 0;

    if (rc < 0)
        s->ending = ENDING_DEAD;
    return rc;
}

/* No picture is ready: see whether --wait is over, get the preview, and take
 * the next message. */
static int
await_picture(struct submit *s)
{
    const struct msg *m;
    bool queued = true;
    int rc;

    if (waited_for_worker(s) && (rc = in_queue(s, &queued)) < 0)
        return rc;
    if (!queued)
        return no_worker(s);
    if ((rc = submit_preview(s)) < 0 || (rc = submit_next(s, &m)) < 0 ||
        (rc = submit_ask_reason(s)) < 0)
        return rc;
    return rc == 0 ? alive(s) : 0;
}

/* Get pictures until the last has come. */
static int
watch(struct submit *s)
{
    const struct msg *m;
    int rc;

    while (s->delivered < s->job->spec->nframes) {
        if (*s->where.wake == 1)
            return submit_cancel(s);
        rc = submit_is_done(s) || s->last.frames_ready > s->delivered
                 ? submit_deliver_frame(s)
                 : await_picture(s);
        if (rc < 0)
            return rc;
    }
    while (!submit_is_done(s)) /* the last picture may come before DONE */
        if ((rc = submit_next(s, &m)) < 0)
            return rc;
    return submit_deliver_stats(s);
}

/* --- launched workers --- */

/* Wait until all launched workers have come, or --wait is over. */
static int
await_workers(struct submit *s)
{
    uint64_t pause_ms = COME_MS, begin_ms = submit_now_ms(s);
    struct roll r;
    int rc;

    if (!s->cb->gathered || s->stage == STAGE_ACCEPTED)
        return 0;
    while ((rc = submit_ask_workers(s, &r)) == 0) {
        rc = s->cb->gathered(s->cb->arg, r.n, r.names, s->err);
        if (rc < 0)
            s->ending = ENDING_DEAD;
        if (rc != 0)
            break;
        if (submit_now_ms(s) - begin_ms > COME_SLOWLY_MS)
            pause_ms = COME_SLOWLY_MS / 10;
        link_pause(&s->where, pause_ms);
    }
    return rc < 0 ? rc : 0;
}

static int
converse(struct submit *s)
{
    int rc;

    s->ending = ENDING_NONE;
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
        return submit_interrupted(s);
    if ((rc = alive(s)) < 0)
        return rc;
    if (s->refusal != REFUSAL_NONE && !s->told_refused &&
        s->stage < STAGE_ACCEPTED)
        s->start_ms = submit_now_ms(s);
    if (s->stage < STAGE_ACCEPTED && waited_since(s, s->start_ms))
        return rad_fail(s->err, why->code, "%s", why->what);
    return 0;
}

/* Say once why the job is tried again. */
static void
say_retry(struct submit *s, const struct rad_error *why)
{
    char text[sizeof why->what + 60], seconds[FIGURE_TEXT];
    bool refused = s->refusal != REFUSAL_NONE;
    bool *told = refused ? &s->told_refused : &s->told_lost;

    if (*told)
        return;
    *told = true;
    if (refused && s->stage < STAGE_ACCEPTED)
        snprintf(text, sizeof text, "%s; trying again for %s s", why->what,
                 figure(seconds, s->job->wait_s, 3));
    else
        snprintf(text, sizeof text, "%s; trying again", why->what);
    s->cb->say(s->cb->arg, text);
}

/* The lesser of ms and the rest of --wait's time, rounded up. */
static uint64_t
within_wait(struct submit *s, uint64_t ms)
{
    double left =
        1000 * s->job->wait_s - (double)(submit_now_ms(s) - s->start_ms);

    if (s->stage == STAGE_ACCEPTED || (double)ms <= left)
        return ms;
    return left > 0 ? (uint64_t)left + 1 : 0;
}

/* How long to wait before the next try: twice as long each time, plus up to a
 * quarter at random, so that many clients do not dial at once; not beyond
 * --wait. */
static uint64_t
backoff_ms(struct submit *s)
{
    uint64_t ms = BACKOFF_MAX_MS, r;
    int n = s->failures++;

    if (s->refusal != REFUSAL_NONE && n > BACKOFFS_IN_LINE)
        n = BACKOFFS_IN_LINE;
    if (n < 6)
        ms = (uint64_t)BACKOFF_MS << n;
    if (uv_random(NULL, NULL, &r, sizeof r, 0, NULL) == 0)
        ms += r % (ms / 4);
    return within_wait(s, ms);
}

static int
connect_to(struct submit *s)
{
    uint64_t ms = within_wait(s, CONNECT_MS);
    int rc =
        link_open(&s->link, &s->where, &s->job->to, MSG_ROLE_USER,
                  (int)(ms > CONNECT_LEAST_MS ? ms : CONNECT_LEAST_MS), s->err);

    s->refusal = rc == RAD_ETEMPFAIL ? REFUSAL_GONE : REFUSAL_NONE;
    if (rc < 0)
        return rc;
    if (s->told_lost && s->connected)
        s->cb->say(s->cb->arg, "connected again");
    s->told_lost = false;
    s->connected = true;
    return 0;
}

/* One connection, from dialling to its end, or to the next time that the
 * coordinator refuses the job on it.  --wait is for a coordinator to be there,
 * so the time that files take to be sent does not count. */
static int
attempt(struct submit *s)
{
    int rc = s->refusal == REFUSAL_IN_LINE ? 0 : connect_to(s);
    uint64_t begin_ms = submit_now_ms(s);

    if (rc < 0)
        return rc;
    s->refusal = REFUSAL_NONE;
    rc = converse(s);
    if (s->refusal == REFUSAL_NONE && s->stage < STAGE_ACCEPTED)
        s->start_ms += submit_now_ms(s) - begin_ms;
    if (s->refusal != REFUSAL_IN_LINE) {
        link_close(s->link);
        s->link = NULL;
    }
    return rc;
}

/* Try until the job is over or trying again makes no sense.  Returns what
 * submit_run() does. */
static int
persevere(struct submit *s)
{
    struct rad_error *err = s->err;
    struct rad_error why;
    int rc;

    for (;;) {
        bool refused = s->refusal != REFUSAL_NONE, again;

        why = (struct rad_error){ 0 };
        s->err = &why;
        rc = attempt(s);
        s->err = err;
        again = s->refusal != REFUSAL_NONE;
        if (again != refused)
            s->failures = 0; /* tries for another reason do not count */
        if ((rc != RAD_EUNAVAIL && !again) || s->ending > ENDING_DONE)
            break;
        if ((rc = may_retry(s, &why)) < 0)
            return rc;
        say_retry(s, &why);
        link_pause(&s->where, backoff_ms(s));
    }
    if (rc < 0 && err)
        *err = why;
    return rc;
}

int
submit_run(const struct submit_job *job, uv_loop_t *loop, const int *interrupts,
           const struct submit_callbacks *cb, struct rad_error *err)
{
    struct submit s = { .job = job, .cb = cb, .err = err };
    int rc;

    msg_job_format(job->spec->job, s.id);
    s.where = (struct link_where){ loop, interrupts };
    s.start_ms = submit_now_ms(&s);
    rc = persevere(&s);
    link_close(s.link);
    return rc;
}
