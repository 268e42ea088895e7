/* yield.c - see yield.h
 *
 * A unit may be a third of a worker's share of a picture, so nothing waits for
 * its end.  A unit is given back (YIELD, GAVE), and its rows and facts are
 * kept, when its job is paused; its worker is to leave; a job of higher
 * priority has a unit for the worker; or its owner has more workers than
 * another owner with a job of the same priority.  Tiles are short: a worker
 * ends those that it has beside the units of the job that it goes to (sched.c).
 * A unit that is to be given back counts as parked, so its worker gets others.
 * Of a window nothing is kept: it is taken back (REVOKE) and begins anew. */
#include "config.h"

#include "sched/yield.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "filling/passes.h"
#include "filling/tiles.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "sched/loss.h"
#include "sched/sched.h"
#include "sched/survey.h"

/* How long an answer to YIELD may take: longer only at a pixel without end. */
#define LOST_MS    30000
#define LEAVING_MS 5000 /* the same, of a worker that is to leave */

/* Has the job, as far as is known, work for the worker? */
static bool
has_some_for(const struct coord *c, const struct job *job, uint32_t index)
{
    const struct job_part *part = &job->parts[index];

    if (desk_idle_job(job) || job->place != PLACE_OPEN ||
        part->state != PART_READY)
        return false;
    if (part->lags)
        return true;
    if (passes_open(job))
        return tiles_has(c, job, index);
    return (job->survey && survey_has(c, job, index)) ||
           (!job->survey && job_waiting(job) > 0 && !part->late &&
            c->now_ms >= part->ask_ms);
}

/* The highest priority of the jobs that the worker works on or could work on.
 */
static int64_t
rank_of(const struct coord *c, const struct coord_worker *w)
{
    for (size_t i = 0; i < c->nbegun; i++) {
        const struct job *job = c->jobs[i];
        uint32_t index = desk_index(job, w);

        if (job->spec.priority <= w->priority)
            break;
        if (index != JOB_NOBODY && has_some_for(c, job, index))
            return job->spec.priority;
    }
    return w->priority;
}

static bool
may_yield(const struct job *job, const struct job_attempt *attempt)
{
    const struct coord_worker *w = job->parts[attempt->part].worker;

    return w->conn != 0 && attempt->state != ATTEMPT_DELIVERED &&
           attempt->state != ATTEMPT_YIELDING &&
           job->parts[attempt->part].state == PART_READY;
}

/* Have one attempt's unit given back; the attempt may be over after that. */
static void
give_back(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    if (!partition_is_strict(job->partition)) {
        loss_taken(c, job, attempt);
        return;
    }
    desk_log_unit(c, job, attempt, "unit yield");
    holding_step(c, job, attempt, ATTEMPT_YIELDING);
    attempt->yield_ms = c->now_ms;
    desk_send_attempt(c, job, MSG_YIELD, attempt);
}

/* Have all given back that the worker has of the job. */
static void
give_all_back(struct coord *c, struct job *job, uint32_t index)
{
    struct attempt_walk walk = attempt_walk(job);
    struct job_attempt *attempt;

    while ((attempt = attempt_next(job, &walk)))
        if (attempt->part == index && may_yield(job, attempt))
            give_back(c, job, attempt);
}

static bool
is_unanswered(const struct coord *c, const struct job *job,
              const struct job_attempt *attempt)
{
    const struct coord_worker *w;

    if (attempt->state != ATTEMPT_YIELDING)
        return false;
    w = job->parts[attempt->part].worker;
    return c->now_ms - attempt->yield_ms >=
           (desk_takes_units(w) ? LOST_MS : LEAVING_MS);
}

/* Take the units from children that did not answer YIELD.  One walk over all
 * units that are out: with many workers these are thousands. */
static void
give_up(struct coord *c, struct job *job)
{
    struct attempt_walk walk = attempt_walk(job);
    struct job_attempt *attempt;

    while ((attempt = attempt_next(job, &walk)))
        if (is_unanswered(c, job, attempt))
            loss_taken(c, job, attempt);
}

static void
look_at_job(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++) {
        const struct job_part *part = &job->parts[i];

        if ((part->in_flight > 0 || part->parked > 0) && desk_gives_way(job, i))
            give_all_back(c, job, i);
    }
    give_up(c, job);
}

/* --- owners --- */

/* The job that this worker works on and that must make way for `job`: of the
 * same priority, and its owner has more threads at work.  NULL: none. */
static struct job *
job_to_yield(const struct coord *c, const struct job *job,
             const struct coord_worker *w)
{
    struct job *has = NULL;

    for (size_t i = 0; i < c->nbegun; i++) {
        struct job *o = c->jobs[i];
        uint32_t index = desk_index(o, w);

        if (index == JOB_NOBODY || o->parts[index].in_flight == 0)
            continue;
        if (o->spec.priority != job->spec.priority || o->payer == job->payer)
            return NULL;
        has = o;
    }
    if (!has || !partition_is_strict(has->partition) ||
        job->payer->threads + 2 * w->threads > has->payer->threads)
        return NULL;
    return has;
}

/* Owners share the workers equally, whatever the order in which they came: an
 * owner with few workers gets some that work for an owner with more. */
static void
share_workers(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++) {
        struct coord_worker *w = job->parts[i].worker;
        struct job *other;

        if (!has_some_for(c, job, i) || job->survey || !desk_takes_units(w) ||
            !(other = job_to_yield(c, job, w)))
            continue;
        give_all_back(c, other, desk_index(other, w));
        sched_serve(c, w);
    }
}

void
yield_look(struct coord *c)
{
    for (struct coord_worker *w = c->workers; w; w = w->next)
        w->rank = w->conn != 0 ? rank_of(c, w) : INT64_MIN;
    for (size_t i = 0; i < c->nbegun; i++)
        if (!job_over(c->jobs[i]) && c->jobs[i]->partition)
            look_at_job(c, c->jobs[i]);
    for (size_t i = 0; i < c->nbegun && !c->full; i++)
        if (!job_over(c->jobs[i]) && c->jobs[i]->partition)
            share_workers(c, c->jobs[i]);
}
