/* order.c - see order.h */
#include "config.h"

#include "desk/order.h"

#include "desk/desk.h"
#include "jobs/job.h"

#include "base/list.h"

#include <string.h>

/* --- by id --- */

static struct job **
chain_of(struct coord *c, const uint8_t *id)
{
    return &c->by_job[msg_job_chain(id, COORD_JOBS)];
}

static void
unchain(struct coord *c, struct job *job)
{
    struct job **at = chain_of(c, job->id);

    while (*at != job)
        at = &(*at)->chain;
    *at = job->chain;
}

struct job *
desk_find_job(const struct coord *c, const uint8_t id[MSG_JOB])
{
    struct job *job = *chain_of((struct coord *)c, id);

    while (job && memcmp(job->id, id, MSG_JOB) != 0)
        job = job->chain;
    return job;
}

struct job *
desk_same_job(const struct coord *c, const uint8_t id[MSG_JOB],
              uint64_t sequence)
{
    struct job *job = desk_find_job(c, id);

    return job && job->sequence == sequence ? job : NULL;
}

/* --- in order --- */

/* A job over whose end the verdict is yet to be carried out counts as open. */
static enum order_rank
rank_of(const struct job *job)
{
    if (!job_over(job) || job->ending)
        return job->nparts > 0 ? ORDER_BEGUN : ORDER_QUEUED;
    return job->place == PLACE_FILED ? ORDER_FILED : ORDER_ENDED;
}

/* The end of a rank in coord.jobs, which is the beginning of the next. */
static size_t *
end_of(struct coord *c, int rank)
{
    size_t *const end[] = { &c->nbegun, &c->nopen, &c->nended, &c->njobs };

    return end[rank];
}

static bool
goes_before(const struct job *a, const struct job *b)
{
    return a->spec.priority > b->spec.priority ||
           (a->spec.priority == b->spec.priority && a->sequence < b->sequence);
}

/* There is room for one more. */
static void
insert(struct coord *c, struct job *job)
{
    enum order_rank rank = rank_of(job);
    size_t first = rank > 0 ? *end_of(c, rank - 1) : 0, i = *end_of(c, rank);

    while (i > first && goes_before(job, c->jobs[i - 1]))
        i--;
    memmove(c->jobs + i + 1, c->jobs + i, (c->njobs - i) * sizeof *c->jobs);
    c->jobs[i] = job;
    job->rank = rank;
    for (int r = (int)rank; r <= ORDER_FILED; r++)
        (*end_of(c, r))++;
}

static void
take_out(struct coord *c, const struct job *job)
{
    size_t i = job->rank > 0 ? *end_of(c, job->rank - 1) : 0;

    while (c->jobs[i] != job)
        i++;
    memmove(c->jobs + i, c->jobs + i + 1, (c->njobs - i - 1) * sizeof *c->jobs);
    for (int r = (int)job->rank; r <= ORDER_FILED; r++)
        (*end_of(c, r))--;
}

bool
order_add(struct coord *c, struct job *job)
{
    struct job **chain = chain_of(c, job->id);

    if (!rad_list_grow(&c->jobs, c->njobs, sizeof *c->jobs))
        return false;
    insert(c, job);
    job->chain = *chain;
    *chain = job;
    return true;
}

void
order_move(struct coord *c, struct job *job)
{
    take_out(c, job);
    insert(c, job);
}

void
order_remove(struct coord *c, struct job *job)
{
    take_out(c, job);
    unchain(c, job);
}
