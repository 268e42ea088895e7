/* worker_post.c - sending to the coordinator and to children; see state.h */
#include "config.h"

#include "worker/state.h"

#include "worker/worker.h"

#include <string.h>
#include <sysexits.h>

#define LAST_REDIAL_MS 30000 /* longest delay before dialling again */

uint64_t
worker_new_conn(struct worker *w)
{
    return ACT_OWN_CONN | ++w->next_conn;
}

uint64_t
worker_redial_ms(struct worker *w, unsigned *delay_ms)
{
    uint64_t delay = *delay_ms;
    uint16_t jitter;

    w->env.random(w->env.arg, &jitter, sizeof jitter);
    *delay_ms = delay < LAST_REDIAL_MS / 2 ? 2 * *delay_ms : LAST_REDIAL_MS;
    return w->now_ms + delay + delay * jitter / 131072;
}

struct wjob *
worker_find_job(const struct worker *w, const uint8_t id[MSG_JOB])
{
    struct wjob *job = w->jobs;

    while (job && memcmp(job->id, id, MSG_JOB) != 0)
        job = job->next;
    return job;
}

void
worker_send_coord(struct worker *w, const struct msg *m)
{
    if (w->coord_state == COORD_WELCOME)
        actions_send(&w->actions, w->coord, m);
}

void
worker_send_drain(struct worker *w)
{
    struct msg m = { .type = MSG_DRAIN,
                     .drain = { w->env.name,
                                w->draining ? MSG_DRAIN_STOPPED : w->away } };

    worker_send_coord(w, &m);
}

void
worker_send_tally(struct worker *w, struct wjob *job)
{
    struct msg m = { .type = MSG_TALLY, .tally = job->tally };

    m.tally.job = job->id;
    m.tally.bytes_in = job->bytes_in;
    m.tally.bytes_out = job->bytes_out;
    m.tally.base_line_bytes = job->base_line_bytes;
    m.tally.base_line_pixels = job->base_line_pixels;
    m.tally.paid = job->paid;
    msg_counts_add(&m.tally.dropped, &job->unpaid);
    worker_send_coord(w, &m);
}

void
worker_send_child_bytes(struct worker *w, struct wjob *job,
                        const uint8_t *bytes, size_t len)
{
    lossy_sent(&job->to_child, len);
    actions_send_bytes(&w->actions, job->child, bytes, len);
}

void
worker_send_child(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wire_out *out = &w->actions.scratch;

    out->len = 0;
    if (msg_pack(out, m) != 0)
        w->actions.failed = true;
    else
        worker_send_child_bytes(w, job, out->buf, out->len);
}

void
worker_stop(struct worker *w, int status, const char *text)
{
    struct action *a;

    if (w->stopped)
        return;
    w->stopped = true;
    a = actions_add(&w->actions, ACT_STOP, 0);
    if (!a)
        return;
    a->status = status;
    a->text = actions_keep_text(&w->actions, text);
}

bool
worker_status_is_local(int status)
{
    switch (status) {
    case EX_NOINPUT:
    case EX_OSERR:
    case EX_OSFILE:
    case EX_CANTCREAT:
    case EX_IOERR:
    case EX_TEMPFAIL:
    case EX_NOPERM:
        return true;
    default:
        return false;
    }
}
