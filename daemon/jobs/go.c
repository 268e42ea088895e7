/* go.c - see go.h
 *
 *       begins: UNIT, a loan, STILL, or rows of an attempt thought lost
 *                                   |
 *              PARKED               v             PARKED, and it lends
 *          .--------------------  WORKING  ---------------------.
 *          v                      ^  |  ^                       v
 *       PARKED ---- top is here --'  |  '-- a loan is over -- BLOCKED
 *          |                         |                          |
 *          |                       YIELD                        |
 *          |                         v                          |
 *          '------- YIELD ------> YIELDING <------ YIELD -------'
 *
 *     these four -> DELIVERED: all rows came
 *     all five   -> OVER:      its rows are kept; the unit was given back
 *                              (GAVE) or taken (REVOKE); the loan was paid
 *                              (PAID); its worker or its child is gone
 *
 * Messages cross, so one may come that does not fit the state any more (PARKED
 * of an attempt that waits already, GAVE without YIELD): it is ignored.
 * holding.c counts a worker's attempts: in_flight those that are WORKING;
 * parked those that are PARKED, BLOCKED or YIELDING; delivered those that are
 * DELIVERED. */
#include "config.h"

#include "jobs/go.h"

#include "jobs/job.h"
#include "jobs/unit.h"
#include "machine/steps.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

const struct steps go_steps = {
    GO_STATES,
    {
        [GO_OVER] = { "over", STEP(GO_WORKING) },
        [GO_WORKING] = { "working", STEP(GO_PARKED) | STEP(GO_BLOCKED) |
                                        STEP(GO_YIELDING) | STEP(GO_DELIVERED) |
                                        STEP(GO_OVER) },
        [GO_PARKED] = { "parked", STEP(GO_WORKING) | STEP(GO_YIELDING) |
                                      STEP(GO_DELIVERED) | STEP(GO_OVER) },
        [GO_BLOCKED] = { "blocked", STEP(GO_WORKING) | STEP(GO_YIELDING) |
                                        STEP(GO_DELIVERED) | STEP(GO_OVER) },
        [GO_YIELDING] = { "yielding", STEP(GO_DELIVERED) | STEP(GO_OVER) },
        [GO_DELIVERED] = { "delivered", STEP(GO_OVER) },
    },
};

void
go_step(struct job_go *go, enum go_state to)
{
    go->state = (enum go_state)steps_take(&go_steps, go->state, to);
}

bool
go_works(const struct job_go *go)
{
    return go->state == GO_WORKING;
}

bool
go_waits(const struct job_go *go)
{
    return go->state == GO_PARKED || go->state == GO_BLOCKED ||
           go->state == GO_YIELDING;
}

static bool
list_out(struct job *job, uint32_t unit)
{
    if (!rad_list_grow(&job->out, job->nout, sizeof *job->out))
        return false;
    job->units[unit].slot = job->nout;
    job->out[job->nout++] = unit;
    return true;
}

struct job_go *
go_add(struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    if (u->ngos == JOB_MAX_GOES)
        return NULL;
    if (!u->go) {
        u->go = malloc(JOB_MAX_GOES * sizeof *u->go);
        if (!u->go)
            return NULL;
        if (!list_out(job, unit)) {
            free(u->go);
            u->go = NULL;
            return NULL;
        }
    }
    if (u->state != UNIT_OUT)
        unit_step(u, UNIT_OUT);
    u->go[u->ngos] = (struct job_go){ .unit = unit };
    return &u->go[u->ngos++];
}

void
go_remove(struct job *job, struct job_go *go)
{
    struct job_unit *u = &job->units[go->unit];

    *go = u->go[--u->ngos];
    if (u->ngos > 0)
        return;
    free(u->go);
    u->go = NULL;
    job->out[u->slot] = job->out[--job->nout];
    job->units[job->out[u->slot]].slot = u->slot;
}

struct job_go *
go_of_worker(const struct job *job, uint32_t unit, uint32_t worker)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->ngos; i++)
        if (u->go[i].worker == worker)
            return &u->go[i];
    return NULL;
}

struct job_go *
go_of_attempt(const struct job *job, uint32_t unit, uint32_t attempt)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->ngos; i++)
        if (u->go[i].attempt == attempt)
            return &u->go[i];
    return NULL;
}

struct job_go *
go_find(const struct job *job, uint32_t unit, uint32_t worker, uint32_t attempt)
{
    struct job_go *go = go_of_worker(job, unit, worker);

    return go && go->attempt == attempt ? go : NULL;
}
