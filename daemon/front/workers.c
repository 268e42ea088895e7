/* workers.c - see workers.h */
#include "config.h"

#include "front/workers.h"

#include "desk/desk.h"
#include "desk/linking.h"
#include "desk/verdict.h"
#include "filling/passes.h"
#include "filling/records.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "lines/handoff.h"
#include "lines/lending.h"
#include "sched/balance.h"
#include "sched/loss.h"
#include "sched/ready.h"
#include "sched/result.h"
#include "sched/survey.h"
#include "sched/tally.h"

#include "base/sha.h"
#include "base/text.h"

#include <stdio.h>
#include <string.h>

static void
send_file(struct coord *c, uint64_t conn, uint32_t request, const uint8_t *hash)
{
    struct action *a = actions_add(&c->actions, ACT_SEND_FILE, conn);

    if (!a)
        return;
    a->request = request;
    a->hash = actions_keep(&c->actions, hash, MSG_HASH);
}

/* Handler of WANT: send a worker the files that it wants, if they belong to the
 * job that the worker loads.  If that job has just ended, JOB_END is on its
 * way. */
static void
on_want(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    const struct job *job = w->loading;
    const struct msg_hashes *f = job ? &job->spec.files : NULL;
    uint8_t *own;
    size_t n;

    if (!f || f->n == 0)
        return;
    own = actions_keep(&c->actions, f->hash, (size_t)f->n * MSG_HASH);
    if (!own)
        return;
    n = rad_sha_unique(own, f->n);
    for (uint32_t i = 0; i < m->want.n; i++) {
        const uint8_t *hash = m->want.hash + (size_t)i * MSG_HASH;

        if (rad_sha_among(own, n, hash))
            send_file(c, w->conn, m->request, hash);
    }
}

/* Handler of PING, which the shell answers: note when the worker's progress
 * counter changes. */
static void
on_ping(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    w->load = m->ping.load;
    if (w->progress == m->ping.progress)
        return;
    w->progress = m->ping.progress;
    w->progressed_ms = c->now_ms;
}

/* Handler of DRAIN: the worker leaves.  It gives back its units, then
 * sched_run() sends BYE. */
static void
on_drain(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    (void)c;
    w->leaving =
        m->drain.why == MSG_DRAIN_ORDER ? MSG_DRAIN_STOPPED : m->drain.why;
}

/* Handler of RECORDS: send ambient records to the connections that watch the
 * job. */
static void
on_records(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    uint32_t index;
    const struct job *job = desk_job_of(c, w, m->records.job, &index);

    if (job && (job->spec.flags & MSG_JOB_RECORDS))
        desk_send_records(c, job, &m->records);
}

static void
on_line_costs(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->line_costs.job, &index);

    if (job)
        frame_add_costs(job, &m->line_costs);
}

/* Handler of FAILED: a child says that no worker can render the job. */
static void
on_failed(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    struct job *job = desk_find_job(c, m->failed.job);
    char text[MSG_MAX_TEXT + 1], why[401];

    if (!job || part_find(job, w->name) == JOB_NOBODY)
        return;
    rad_text_print(why, sizeof why, "%s", m->failed.text);
    snprintf(text, sizeof text, "%s (worker %s)", why, w->name);
    verdict_job(c, job, JOB_FAILED, m->failed.status, text);
}

/* Handler of READY.  A worker that was not connected when others were expelled
 * still has its links with them: it is told to end these now. */
static void
on_ready(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    const struct job *job;
    uint32_t index;

    ready_came(c, w, m);
    job = desk_find_job(c, m->ready.job);
    index = job ? desk_index(job, w) : JOB_NOBODY;
    if (index == JOB_NOBODY || !desk_is_ready(job, index))
        return;
    for (uint32_t i = 0; i < job->nparts; i++)
        if (job->parts[i].worker->expelled)
            linking_end(c, job, w, job->parts[i].worker);
}

/* Handlers of workers' messages.  BYE has none: the connection ends after it.
 */
static const struct {
    enum msg_type type;
    void (*handle)(struct coord *c, struct coord_worker *w,
                   const struct msg *m);
} handlers[] = {
    { MSG_RESULT, result_rows },
    { MSG_READY, on_ready },
    { MSG_LOST, loss_reported },
    { MSG_TALLY, tally_came },
    { MSG_FACTS, handoff_facts },
    { MSG_BASE_LINE, handoff_base_line },
    { MSG_GUESS, handoff_guess },
    { MSG_PARKED, handoff_parked },
    { MSG_GAVE, balance_gave },
    { MSG_STILL, loss_still },
    { MSG_ESTIMATED, survey_estimated },
    { MSG_LOAN, lending_loan },
    { MSG_PAID, lending_paid },
    { MSG_ROOM, loss_no_room },
    { MSG_WANT, on_want },
    { MSG_FAILED, on_failed },
    { MSG_DRAIN, on_drain },
    { MSG_PING, on_ping },
    { MSG_RECORDS, on_records },
    { MSG_TILE_MADE, passes_made },
    { MSG_HOLDS, records_holds },
    { MSG_LINE_COSTS, on_line_costs },
};

void
workers_handle(struct coord *c, struct coord_worker *w, const struct msg *m)
{
    for (size_t i = 0; i < sizeof handlers / sizeof handlers[0]; i++)
        if (handlers[i].type == m->type) {
            handlers[i].handle(c, w, m);
            return;
        }
}
