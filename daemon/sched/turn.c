/* turn.c - see turn.h */
#include "config.h"

#include "sched/turn.h"

#include "desk/holding.h"
#include "filling/passes.h"
#include "jobs/job.h"
#include "jobs/part.h"

bool
turn_is_new(const struct job *job, uint32_t index)
{
    return index == JOB_NOBODY || !part_is_here(&job->parts[index]);
}

/* May the job have something for the worker?  A worker loads new jobs one at a
 * time, even before there is room for their rows.  So a search looks at one of
 * them, however many wait; at none if !news. */
static bool
may_look(const struct job *job, const struct coord_worker *w, bool news)
{
    uint32_t index = desk_index(job, w);

    if (!turn_is_new(job, index))
        return true;
    return news && !w->loading &&
           (index == JOB_NOBODY || job->parts[index].state == PART_GONE);
}

/* Threads that work for the job's owner.  For an owner whose tiles the worker
 * makes the worker's own do not count: they would as well for any other owner.
 * So a worker leaves an owner's tiles only if owners have more equal shares
 * then. */
static uint32_t
threads_beside(const struct job *job, const struct coord_worker *w)
{
    const struct job *at = w->fills;

    if (!at || at->payer != job->payer)
        return job->payer->threads;
    return job->payer->threads - at->parts[desk_index(at, w)].counted_threads;
}

/* Has the worker units of the job, or does it make the job's tiles? */
static bool
is_at(const struct job *job, const struct coord_worker *w)
{
    return w->fills == job || holding_has_any(job, w);
}

bool
turn_is_ahead(const struct job *job, const struct coord_worker *w,
              uint32_t index)
{
    return w->in_flight > 0 && !is_at(job, w) &&
           job->parts[index].state == PART_READY &&
           (passes_open(job) || job->survey || job_waiting(job) > 0);
}

/* Note for which owners the worker works. */
void
turn_begin(struct coord *c, const struct coord_worker *w)
{
    c->serving++;
    for (size_t i = 0; i < c->nbegun; i++)
        if (is_at(c->jobs[i], w))
            c->jobs[i]->payer->served = c->serving;
}

/* Does job a go before job b?  Of one owner's jobs of the same priority the
 * older always goes first. */
static bool
goes_before(const struct coord *c, const struct coord_worker *w,
            const struct job *a, const struct job *b)
{
    uint32_t at_a = threads_beside(a, w), at_b = threads_beside(b, w);
    bool serves_a = a->payer->served == c->serving,
         serves_b = b->payer->served == c->serving;

    if (a->spec.priority != b->spec.priority)
        return a->spec.priority > b->spec.priority;
    if (at_a != at_b)
        return at_a < at_b;
    return serves_a != serves_b ? serves_a : a->sequence < b->sequence;
}

/* The best job, or `best`, of these, which are of one rank and so in order. */
static struct job *
best_of(const struct coord *c, const struct coord_worker *w, bool news,
        size_t first, size_t end, struct job *best)
{
    for (size_t i = first; i < end; i++) {
        struct job *job = c->jobs[i];

        if (best && job->spec.priority < best->spec.priority)
            break;
        if (job->served != c->serving && !desk_idle_job(job) &&
            may_look(job, w, news) && (!best || goes_before(c, w, job, best)))
            best = job;
    }
    return best;
}

struct job *
turn_next(const struct coord *c, const struct coord_worker *w, bool news)
{
    struct job *best = best_of(c, w, news, 0, c->nbegun, NULL);

    if (!news || w->loading) /* then it has nothing to do with those queued */
        return best;
    return best_of(c, w, news, c->nbegun, c->nopen, best);
}
