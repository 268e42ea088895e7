/* submit_talk.c - messages of the coordinator, and the job cancelled; see
 * submit_impl.h */
#include "config.h"

#include "link/submit_impl.h"

#include <string.h>
#include <sysexits.h>

enum {
    LOOK_MS = 500,   /* longest wait for a message before other checks */
    CANCEL_MS = 5000 /* longest wait for a job to be cancelled */
};

uint64_t
submit_now_ms(const struct submit *s)
{
    uv_update_time(s->where.loop);
    return uv_now(s->where.loop);
}

static bool
is_ours(const struct submit *s, const uint8_t *job)
{
    static const uint8_t none[MSG_JOB];

    return memcmp(job, s->job->spec->job, MSG_JOB) == 0 ||
           memcmp(job, none, MSG_JOB) == 0;
}

void
submit_reach(struct submit *s, enum stage to)
{
    if (to >= STAGE_KNOWN && s->stage < STAGE_KNOWN && s->cb->accepted)
        s->cb->accepted(s->cb->arg);
    if (s->stage < to)
        s->stage = to;
}

/* --- messages that may come at any time --- */

bool
submit_stands_still(const struct submit *s)
{
    return s->last.state == MSG_STATE_HELD || s->last.state == MSG_STATE_PAUSED;
}

static void
take_progress(struct submit *s, const struct msg_progress *m)
{
    bool stood = submit_stands_still(s);

    s->last = *m;
    if (memcmp(m->job, s->job->spec->job, MSG_JOB) == 0)
        submit_reach(s, STAGE_KNOWN);
    /* it may have begun and left between two reports */
    if (m->workers > 0 || m->state == MSG_STATE_RUNNING)
        s->met_worker = true;
    if (s->wait_ms == 0 || stood)
        s->wait_ms = submit_now_ms(s);
    if (s->cb->progress)
        s->cb->progress(s->cb->arg, m);
}

static void
take_done(struct submit *s)
{
    if (s->ending == ENDING_NONE)
        s->ending = ENDING_DONE;
    else if (s->ending == ENDING_CANCEL)
        s->ending = ENDING_LATE;
}

static int
take_failed(struct submit *s, const struct msg *m)
{
    bool cancelled = s->ending == ENDING_CANCEL;

    if ((s->fetching && m->request == s->request) || s->ending == ENDING_LATE)
        return 0;
    /* not taken now, but perhaps later: of a job that fails with that status
     * the coordinator has told the progress before */
    if (s->stage < STAGE_KNOWN && m->failed.status == EX_TEMPFAIL)
        s->refusal = REFUSAL_GONE;
    else
        s->ending = ENDING_OVER;
    if (cancelled)
        return submit_interrupted(s);
    return rad_fail(s->err, link_code(m->failed.status), "%s", m->failed.text);
}

static int
take(struct submit *s, const struct msg *m)
{
    if (m->type == MSG_PROGRESS && is_ours(s, m->progress.job))
        take_progress(s, &m->progress);
    else if (m->type == MSG_RECORDS && is_ours(s, m->records.job) &&
             s->cb->records)
        s->cb->records(s->cb->arg, &m->records);
    else if (m->type == MSG_DONE && is_ours(s, m->done.job))
        take_done(s);
    else if (m->type == MSG_FAILED && is_ours(s, m->failed.job))
        return take_failed(s, m);
    return 0;
}

int
submit_next(struct submit *s, const struct msg **m)
{
    int rc;

    if (*s->where.wake > (s->stage >= STAGE_KNOWN ? 1 : 0))
        return submit_interrupted(s);
    rc = link_recv(s->link, LOOK_MS, m, s->err);
    if (rc == 1) {
        int taken = take(s, *m);

        if (taken < 0)
            return taken;
    }
    return rc;
}

bool
submit_is_settled(const struct submit *s)
{
    return s->ending == ENDING_OVER || submit_is_done(s) || s->cb->alive;
}

int
submit_cancel(struct submit *s)
{
    struct msg m = { .type = MSG_CANCEL, .request = ++s->request };
    const struct msg *answer;
    uint64_t until = submit_now_ms(s) + CANCEL_MS;
    int rc;

    s->ending = submit_is_done(s) ? ENDING_LATE : ENDING_CANCEL;
    m.cancel.job = s->job->spec->job;
    rc = link_send(s->link, &m, s->err);
    while (rc >= 0 && submit_now_ms(s) < until) {
        rc = submit_next(s, &answer);
        if (rc == 1 && answer->request == s->request &&
            (answer->type == MSG_ANSWER || answer->type == MSG_FAILED)) {
            if (s->ending == ENDING_CANCEL)
                s->ending = ENDING_OVER;
            break;
        }
    }
    if (!submit_is_settled(s))
        return submit_not_settled(s);
    if (!submit_is_done(s) || s->cb->alive)
        submit_say_what_it_got(s);
    return submit_interrupted(s);
}

int
submit_await(struct submit *s, uint16_t type, const struct msg **m)
{
    int rc;

    do {
        /* the job waits for room, so the first interrupt cancels it here */
        if (*s->where.wake == 1 && s->stage == STAGE_KNOWN)
            return submit_cancel(s);
        rc = submit_next(s, m);
    } while (rc == 0 || (rc == 1 && (*m)->type != type));
    return rc < 0 ? rc : 0;
}
