/* sched_tick.c - what the scheduler does as time passes */
#include "config.h"

#include "sched/sched.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/speed.h"
#include "jobs/attempt.h"
#include "jobs/job.h"
#include "jobs/progress.h"
#include "lines/handoff.h"
#include "lines/lending.h"
#include "sched/balance.h"
#include "sched/loss.h"
#include "sched/yield.h"

#define DRAIN_WAIT_MS 500 /* time for the facts of a parked unit to come */

/* Take units that only wait from workers that get no more units: their facts
 * are here, for the workers that get them next. */
static void
drain_parked(struct coord *c, struct job *job)
{
    struct attempt_walk walk = attempt_walk(job);
    struct job_attempt *attempt;

    while ((attempt = attempt_next(job, &walk)))
        if (attempt_waits(attempt) && attempt->state != ATTEMPT_YIELDING &&
            !attempt->handoff.top_sent &&
            c->now_ms - attempt->parked_ms >= DRAIN_WAIT_MS &&
            !desk_takes_units(job->parts[attempt->part].worker))
            loss_taken(c, job, attempt);
}

void
sched_tick(struct coord *c)
{
    balance_look(c);
    yield_look(c);
    for (size_t i = 0; i < c->nbegun; i++) {
        struct job *job = c->jobs[i];

        if (job_over(job))
            continue;
        progress_pace(job, c->now_ms,
                      job->state == JOB_RUNNING ? holding_workers(job) : 0);
        if (!job->partition)
            continue;
        speed_measure(c, job);
        loss_tick(c, job);
        if (!job->shared)
            continue;
        handoff_tick(c, job);
        lending_tick(c, job);
        drain_parked(c, job);
    }
    sched_run(c);
}
