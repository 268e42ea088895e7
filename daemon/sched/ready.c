/* ready.c - see ready.h */
#include "config.h"

#include "sched/ready.h"

#include "desk/desk.h"
#include "desk/feeding.h"
#include "desk/linking.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "filling/passes.h"
#include "filling/records.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "lines/handoff.h"
#include "sched/loss.h"
#include "sched/survey.h"

/* With --same-bits: are these the bits of the job's first worker? */
static bool
same_bits(const struct job *job, uint64_t fingerprint)
{
    const struct job_part *first = part_first(job);

    return !(job->spec.flags & MSG_JOB_SAME_BITS) || !first ||
           first->fingerprint == fingerprint;
}

static void
worker_ready(struct coord *c, struct job *job, struct coord_worker *w,
             struct job_part *part, const struct msg_ready *m)
{
    part_step(part, PART_READY);
    part->load_s = m->load_s;
    part->fingerprint = w->fingerprint = m->fingerprint;
    part->threads = w->threads = m->threads;
    if (part->ready_ms == 0)
        part->ready_ms = c->now_ms;
    part->took_part = true;
    linking_join(c, job, (uint32_t)(part - job->parts));
    if (job->filling)
        feeding_join(c, job, (uint32_t)(part - job->parts));
}

/* The first worker is ready: lay out the job's units; false: the job failed. */
static bool
lay_out(struct coord *c, struct job *job)
{
    struct rad_error err = { 0 };

    if (job_split(job, &err) != 0 || passes_begin(c, job, &err) != 0 ||
        survey_begin(job, job_active(job), &err) != 0) {
        verdict_job(c, job, JOB_FAILED, rad_exit_status(err.code), err.what);
        return false;
    }
    if (!job->survey && !passes_open(job))
        speed_share(c, job);
    return true;
}

/* The first worker is ready for a job of which an earlier life of the
 * coordinator handed out units; false: the job failed. */
static bool
take_up_restored(struct coord *c, struct job *job)
{
    struct rad_error err = { 0 };

    job->restored = false;
    if (passes_begin(c, job, &err) != 0) {
        verdict_job(c, job, JOB_FAILED, rad_exit_status(err.code), err.what);
        return false;
    }
    if (!passes_open(job))
        speed_share(c, job);
    return true;
}

/* Let a worker end the job that cannot take part in it, now or at all. */
static void
turn_away(struct coord *c, struct coord_worker *w, struct job *job,
          uint32_t index, enum part_state to)
{
    loss_all(c, job, index, to);
    desk_send_job_end(c, w->conn, job->id);
}

void
ready_came(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_ready *m = &msg->ready;
    struct job_part *part;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);

    if (!job)
        return;
    if (w->loading == job)
        w->loading = NULL;
    part = &job->parts[index];
    if (part->state != PART_LOADING)
        return;
    if (!same_bits(job, m->fingerprint)) {
        w->fingerprint = m->fingerprint;
        actions_log(&c->actions, ACT_WARN,
                    "worker excluded job=%s worker=%s why=--same-bits, and its "
                    "arithmetic differs from that of the job's first worker",
                    job->hex, part->name);
        turn_away(c, w, job, index, PART_EXCLUDED);
        return;
    }
    if (!job->partition) {
        if (!lay_out(c, job))
            return;
        speed_measure(c, job);
    }
    if (job->restored && !take_up_restored(c, job))
        return;
    if (!records_ready(c, job, index, m->passes)) {
        turn_away(c, w, job, index, PART_GONE); /* it has passes of an earlier
                                                 * life */
        return;
    }
    loss_at_ready(c, job, index);
    worker_ready(c, job, w, part, m);
    if (job->shared)
        handoff_back(c, job, index);
    speed_measure(c, job);
}
