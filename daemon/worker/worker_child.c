/* worker_child.c - messages of a job's child to its worker
 *
 * child_handlers[] has the handler of each message; relay.c has the others.  A
 * child has one job, so its messages count as about that job, whatever id they
 * carry.  They are passed on if the coordinator is there; results are kept in
 * any case. */
#include "config.h"

#include "worker/worker_says.h"

#include "worker/gather.h"
#include "worker/link.h"
#include "worker/relay.h"
#include "worker/state.h"
#include "worker/wjob.h"
#include "worker/worker.h"

#include <stdio.h>
#include <string.h>
#include <sysexits.h>

static void
child_ready(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg ready = { .type = MSG_READY, .ready = m->ready };

    if (job->state != WJOB_LOADING)
        return;
    wjob_step(job, WJOB_READY);
    job->ready = m->ready;
    job->ready.job = ready.ready.job = job->id;
    job->ready.passes = ready.ready.passes = 0;
    memset(job->ntiles, 0, sizeof job->ntiles);
    gather_turn(job);
    actions_session(&w->actions, job->child, MSG_AT_PARENT, MSG_VERSION);
    worker_send_coord(w, &ready);
}

static void
child_result(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wire_out *out = &w->actions.scratch;
    struct msg pass = *m;
    const struct msg_result *r = &m->result;

    if (!wjob_has_attempt(job, r->unit, r->attempt))
        return; /* the unit was revoked meanwhile */
    pass.result.job = job->id;
    pass.request = 0;
    out->len = 0;
    if (msg_pack(out, &pass) != 0 || !wjob_keep(job, r, out->buf, out->len)) {
        w->actions.failed = true;
        return;
    }
    w->progress++;
    job->bytes_out += out->len;
    if (r->last)
        wjob_drop_attempt(job, r->unit, r->attempt);
    if (w->coord_state == COORD_WELCOME && job->started)
        actions_send_bytes(&w->actions, w->coord, out->buf, out->len);
}

static void
child_tally(struct worker *w, struct wjob *job, const struct msg *m)
{
    if (m->tally.rays_under_way != job->tally.rays_under_way)
        w->progress++;
    job->tally = m->tally;
    worker_send_tally(w, job);
}

/* Kill the child and tell the coordinator that it is lost. */
static void
lose_child(struct worker *w, struct wjob *job, int status, const char *text)
{
    actions_log(&w->actions, ACT_WARN, "child lost job=%s why=%s", job->hex,
                text);
    wjob_kill_child(w, job);
    wjob_send_lost(w, job, status, text);
}

static void
child_failed(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg failed = { .type = MSG_FAILED, .failed = m->failed };

    failed.failed.job = job->id;
    /* a fault of the scene is the same at all workers; with a fault of this
     * machine or of radd itself another worker may try */
    if (m->failed.status == EX_SOFTWARE ||
        worker_status_is_local(m->failed.status)) {
        lose_child(w, job, m->failed.status, m->failed.text);
        return;
    }
    actions_log(&w->actions, ACT_WARN, "job failed job=%s why=%s", job->hex,
                m->failed.text);
    worker_send_coord(w, &failed);
    wjob_kill_child(w, job);
    wjob_drop_attempts(job);
    wjob_step(job, WJOB_IDLE);
}

/* Pass on records of the child. */
static void
child_ambient(struct worker *w, struct wjob *job, const struct msg *m)
{
    const struct msg_ambient *a = &m->ambient;
    struct msg records = { .type = MSG_RECORDS,
                           .records = { job->id, a->count, a->data, a->len } };

    if (job->flags & MSG_JOB_SHARE)
        link_spread(w, job, a);
    if (job->flags & MSG_JOB_RECORDS && job->started)
        worker_send_coord(w, &records);
}

static const struct {
    enum msg_type type;
    void (*handle)(struct worker *w, struct wjob *job, const struct msg *m);
} child_handlers[] = {
    { MSG_RESULT, child_result }, { MSG_AMBIENT, child_ambient },
    { MSG_TALLY, child_tally },   { MSG_READY, child_ready },
    { MSG_FAILED, child_failed },
};

void
worker_from_child(struct worker *w, struct wjob *job, const struct msg *m)
{
    job->heard_ms = w->awake_ms;
    for (size_t i = 0; i < sizeof child_handlers / sizeof child_handlers[0];
         i++)
        if (child_handlers[i].type == m->type) {
            child_handlers[i].handle(w, job, m);
            return;
        }
    w->progress++;
    relay_up(w, job, m);
}

static bool
has_tiles(const struct wjob *job)
{
    for (int i = 0; i < WJOB_PASSES; i++)
        if (job->ntiles[i] > 0)
            return true;
    return false;
}

void
worker_watch_children(struct worker *w)
{
    char text[64];

    for (struct wjob *job = w->jobs; job; job = job->next) {
        bool at_work =
            job->state == WJOB_LOADING || job->nattempts > 0 || has_tiles(job);

        if (!job->child || !at_work || job->held)
            job->heard_ms = w->awake_ms;
        if (w->env.load_s == 0 ||
            w->awake_ms - job->heard_ms < UINT64_C(1000) * w->env.load_s)
            continue;
        snprintf(text, sizeof text, "silent for %u s", w->env.load_s);
        lose_child(w, job, EX_SOFTWARE, text);
    }
}
