/* yield.c - units that go back, for work that comes first
 *
 * A unit may be a third of a worker's share of a picture, so nothing waits for
 * its end.  A unit goes back (YIELD, GAVE), with its rows and facts kept, when
 * its job is paused, when its worker is to leave, when a job of higher priority
 * has a unit for the worker, and when its owner has more of the workers than
 * another owner with a job as urgent.  Every tick looks for such units.
 * A unit that was told to go back counts as parked: its worker gets others.  Of
 * a window nothing can be kept: it is taken back (REVOKE), and begun anew.
 * Estimates (survey.c) end as well (REST). */
#include "config.h"

#include "sched/yield.h"

#include "desk/desk.h"
#include "desk/hold.h"
#include "filling/passes.h"
#include "filling/tiles.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "sched/loss.h"
#include "sched/sched.h"
#include "sched/survey.h"

/* A child that has not answered YIELD by then is at a pixel without end. */
#define LOST_MS    30000
#define LEAVING_MS 5000 /* the same for a worker that is to leave */

/* Has the job, as far as is known, a unit or areas for the worker? */
static bool
has_some_for(const struct coord *c, const struct job *job, uint32_t index)
{
    const struct job_worker *jw = &job->workers[index];

    if (desk_idle_job(job) || job->stage != STAGE_OPEN ||
        jw->state != PART_READY)
        return false;
    if (jw->lags)
        return true;
    if (passes_open(job))
        return tiles_has(c, job, index);
    return (job->survey && survey_has(c, job, index)) ||
           (!job->survey && job_waiting(job) > 0 && !jw->late &&
            c->now_ms >= jw->ask_ms);
}

/* The priority of the job that the worker is at, or could be at. */
static int64_t
rank_of(const struct coord *c, const struct coord_worker *w)
{
    for (size_t i = 0; i < c->njobs; i++) {
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
may_yield(const struct job *job, const struct job_go *go)
{
    const struct coord_worker *w = job->workers[go->worker].worker;

    return w->conn != 0 && go->state != GO_DELIVERED &&
           go->state != GO_YIELDING &&
           job->workers[go->worker].state == PART_READY;
}

/* The attempt is over then, unless its worker is to answer. */
static void
give_back(struct coord *c, struct job *job, uint32_t unit, struct job_go *go)
{
    if (!partition_is_strict(job->partition)) {
        loss_taken(c, job, unit, go);
        return;
    }
    desk_log_unit(c, job, unit, go, "unit yield");
    hold_step(c, job, unit, go, GO_YIELDING);
    go->yield_ms = c->now_ms;
    desk_send_attempt(c, job, MSG_YIELD, unit, go);
}

/* Have the worker leave its estimates. */
static void
rest(struct coord *c, struct job *job, uint32_t index)
{
    struct job_worker *jw = &job->workers[index];
    struct msg m = { .type = MSG_REST, .rest = { job->id } };

    if (jw->rest_ms != 0 || jw->state != PART_READY || jw->worker->conn == 0 ||
        !jw->surveying)
        return;
    survey_rest(job, index);
    jw->rest_ms = c->now_ms;
    actions_send(&c->actions, jw->worker->conn, &m);
}

/* Have all that the worker has of the job go back. */
static void
give_all_back(struct coord *c, struct job *job, uint32_t index)
{
    rest(c, job, index);
    for (uint32_t i = job->nout; i-- > 0;) {
        uint32_t unit = job->out[i];
        struct job_unit *u = &job->units[unit];

        for (uint8_t k = u->ngos; k-- > 0;)
            if (k < u->ngos && u->go[k].worker == index &&
                may_yield(job, &u->go[k]))
                give_back(c, job, unit, &u->go[k]);
    }
}

static bool
is_unanswered(const struct coord *c, const struct job *job,
              const struct job_go *go)
{
    const struct coord_worker *w;

    if (go->state != GO_YIELDING)
        return false;
    w = job->workers[go->worker].worker;
    return c->now_ms - go->yield_ms >=
           (desk_takes_units(w) ? LOST_MS : LEAVING_MS);
}

/* Units of a child that does not answer are lost.  A single walk over all units
 * that are out, of which there may be thousands, with many workers. */
static void
give_up(struct coord *c, struct job *job)
{
    for (uint32_t i = job->nout; i-- > 0;) {
        uint32_t unit = job->out[i];
        struct job_unit *u = &job->units[unit];

        for (uint8_t k = u->ngos; k-- > 0;)
            if (k < u->ngos && is_unanswered(c, job, &u->go[k]))
                loss_taken(c, job, unit, &u->go[k]);
    }
}

static void
look_at_job(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nworkers; i++) {
        const struct job_worker *jw = &job->workers[i];

        if (jw->in_flight == 0 && jw->parked == 0 && !jw->surveying)
            continue;
        if (desk_gives_way(job, i))
            give_all_back(c, job, i);
    }
    give_up(c, job);
}

/* --- owners --- */

/* The job on this worker that has to make way for `job`, since its owner has
 * more of the workers than the owner of `job`; NULL: none. */
static struct job *
richer(const struct coord *c, const struct job *job,
       const struct coord_worker *w)
{
    struct job *has = NULL;

    for (size_t i = 0; i < c->njobs; i++) {
        struct job *o = c->jobs[i];
        uint32_t index = desk_index(o, w);

        if (index == JOB_NOBODY || o->workers[index].in_flight == 0)
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

/* Owners share the workers equally, in whatever order they came: an owner with
 * fewer workers gets some that work at an equal priority for another. */
static void
share(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nworkers; i++) {
        struct coord_worker *w = job->workers[i].worker;
        struct job *other;

        if (!has_some_for(c, job, i) || job->survey || passes_open(job) ||
            !desk_takes_units(w) || !(other = richer(c, job, w)))
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
    for (size_t i = 0; i < c->njobs; i++)
        if (!job_over(c->jobs[i]) && c->jobs[i]->partition)
            look_at_job(c, c->jobs[i]);
    for (size_t i = 0; i < c->njobs && !c->full; i++)
        if (!job_over(c->jobs[i]) && c->jobs[i]->partition)
            share(c, c->jobs[i]);
}
