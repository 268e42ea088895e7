/* linking.c - see linking.h
 *
 * job->links lists the links that linking_need() made; NULL: it made none. */
#include "config.h"

#include "links/linking.h"

#include "jobs/job.h"
#include "jobs/part.h"
#include "links/introduce.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

#define MOST_LINKED 256 /* links of a new worker, with --ambient=live */
#define MOST_NEEDED 16  /* links of a worker that linking_need() made */

/* Two linked workers of the job, by index; a < b. */
struct pair {
    uint32_t a, b;
};

struct links {
    struct pair *pair; /* the oldest link first */
    size_t n;
};

void
linking_free(struct links *l)
{
    if (!l)
        return;
    free(l->pair);
    free(l);
}

static bool
can_be_linked(const struct job *job, uint32_t a, uint32_t b)
{
    return a != b && desk_is_ready(job, a) && desk_is_ready(job, b) &&
           introduce_can(job->workers[a].worker, job->workers[b].worker);
}

static bool
shares_records(const struct job *job)
{
    return job->spec.flags & MSG_JOB_SHARE;
}

static bool
pair_has(const struct pair *p, uint32_t index)
{
    return p->a == index || p->b == index;
}

/* Add a pair to the list; false: memory is out. */
static bool
note_link(struct links *l, uint32_t a, uint32_t b)
{
    if (!rad_list_grow(&l->pair, l->n, sizeof *l->pair))
        return false;
    l->pair[l->n++] = (struct pair){ a < b ? a : b, a < b ? b : a };
    return true;
}

static void
end_link(struct coord *c, struct job *job, size_t i)
{
    struct links *l = job->links;
    const uint32_t end[2] = { l->pair[i].a, l->pair[i].b };

    for (int k = 0; k < 2; k++)
        if (job->workers[end[k]].worker->conn != 0 &&
            part_is_here(&job->workers[end[k]]))
            introduce_unlink(c, job, job->workers[end[k]].worker,
                             job->workers[end[!k]].worker);
    memmove(&l->pair[i], &l->pair[i + 1], (--l->n - i) * sizeof l->pair[0]);
}

void
linking_join(struct coord *c, struct job *job, uint32_t index)
{
    if (shares_records(job))
        introduce_worker(c, job, index, MOST_LINKED);
}

void
linking_left(struct coord *c, struct job *job, uint32_t index)
{
    struct links *l = job->links;

    for (size_t i = l ? l->n : 0; i-- > 0;)
        if (pair_has(&l->pair[i], index))
            end_link(c, job, i);
}

/* End the worker's oldest link, if it has MOST_NEEDED links or more. */
static void
make_room(struct coord *c, struct job *job, uint32_t index)
{
    const struct links *l = job->links;
    size_t oldest = l->n, n = 0;

    for (size_t i = l->n; i-- > 0;)
        if (pair_has(&l->pair[i], index)) {
            oldest = i;
            n++;
        }
    if (n >= MOST_NEEDED)
        end_link(c, job, oldest);
}

static bool
is_linked(const struct links *l, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < l->n; i++)
        if (pair_has(&l->pair[i], a) && pair_has(&l->pair[i], b))
            return true;
    return false;
}

void
linking_need(struct coord *c, struct job *job, uint32_t a, uint32_t b)
{
    if (shares_records(job) || !can_be_linked(job, a, b))
        return;
    if (!job->links)
        job->links = calloc(1, sizeof *job->links);
    if (!job->links) {
        c->actions.failed = true;
        return;
    }
    if (is_linked(job->links, a, b))
        return;
    make_room(c, job, a);
    make_room(c, job, b);
    introduce_link(c, job, job->workers[a].worker, job->workers[b].worker);
    if (!note_link(job->links, a, b))
        c->actions.failed = true;
}
