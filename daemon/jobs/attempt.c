/* attempt.c - see attempt.h
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

#include "jobs/attempt.h"

#include "jobs/job.h"
#include "jobs/unit.h"
#include "machine/steps.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>

const struct steps attempt_steps = {
    ATTEMPT_STATES,
    {
        [ATTEMPT_OVER] = { "over", STEP(ATTEMPT_WORKING) },
        [ATTEMPT_WORKING] = { "working", STEP(ATTEMPT_PARKED) |
                                             STEP(ATTEMPT_BLOCKED) |
                                             STEP(ATTEMPT_YIELDING) |
                                             STEP(ATTEMPT_DELIVERED) |
                                             STEP(ATTEMPT_OVER) },
        [ATTEMPT_PARKED] = { "parked",
                             STEP(ATTEMPT_WORKING) | STEP(ATTEMPT_YIELDING) |
                                 STEP(ATTEMPT_DELIVERED) | STEP(ATTEMPT_OVER) },
        [ATTEMPT_BLOCKED] = { "blocked", STEP(ATTEMPT_WORKING) |
                                             STEP(ATTEMPT_YIELDING) |
                                             STEP(ATTEMPT_DELIVERED) |
                                             STEP(ATTEMPT_OVER) },
        [ATTEMPT_YIELDING] = { "yielding",
                               STEP(ATTEMPT_DELIVERED) | STEP(ATTEMPT_OVER) },
        [ATTEMPT_DELIVERED] = { "delivered", STEP(ATTEMPT_OVER) },
    },
};

void
attempt_step(struct job_attempt *attempt, enum attempt_state to)
{
    attempt->state =
        (enum attempt_state)steps_take(&attempt_steps, attempt->state, to);
}

bool
attempt_works(const struct job_attempt *attempt)
{
    return attempt->state == ATTEMPT_WORKING;
}

bool
attempt_waits(const struct job_attempt *attempt)
{
    return attempt->state == ATTEMPT_PARKED ||
           attempt->state == ATTEMPT_BLOCKED ||
           attempt->state == ATTEMPT_YIELDING;
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

struct job_attempt *
attempt_add(struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    if (u->nattempts == JOB_MAX_ATTEMPTS)
        return NULL;
    if (!u->attempts) {
        u->attempts = malloc(JOB_MAX_ATTEMPTS * sizeof *u->attempts);
        if (!u->attempts)
            return NULL;
        if (!list_out(job, unit)) {
            free(u->attempts);
            u->attempts = NULL;
            return NULL;
        }
    }
    if (u->state != UNIT_OUT)
        unit_step(u, UNIT_OUT);
    u->attempts[u->nattempts] = (struct job_attempt){ .unit = unit };
    return &u->attempts[u->nattempts++];
}

void
attempt_remove(struct job *job, struct job_attempt *attempt)
{
    struct job_unit *u = &job->units[attempt->unit];

    *attempt = u->attempts[--u->nattempts];
    if (u->nattempts > 0)
        return;
    free(u->attempts);
    u->attempts = NULL;
    job->out[u->slot] = job->out[--job->nout];
    job->units[job->out[u->slot]].slot = u->slot;
}

struct attempt_walk
attempt_walk(const struct job *job)
{
    return (struct attempt_walk){ .left = job->nout };
}

struct job_attempt *
attempt_next(const struct job *job, struct attempt_walk *walk)
{
    for (;;) {
        while (walk->n > 0) /* fewer are left if some were ended */
            if (--walk->n < job->units[walk->unit].nattempts)
                return &job->units[walk->unit].attempts[walk->n];
        if (walk->left == 0)
            return NULL;
        walk->unit = job->out[--walk->left];
        walk->n = job->units[walk->unit].nattempts;
    }
}

struct job_attempt *
attempt_first(const struct job *job, uint32_t unit)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].origin != ATTEMPT_LOAN)
            return &u->attempts[i];
    return NULL;
}

struct job_attempt *
attempt_of_part(const struct job *job, uint32_t unit, uint32_t part)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].part == part)
            return &u->attempts[i];
    return NULL;
}

struct job_attempt *
attempt_of_number(const struct job *job, uint32_t unit, uint32_t number)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].number == number)
            return &u->attempts[i];
    return NULL;
}

struct job_attempt *
attempt_find(const struct job *job, uint32_t unit, uint32_t part,
             uint32_t number)
{
    struct job_attempt *attempt = attempt_of_part(job, unit, part);

    return attempt && attempt->number == number ? attempt : NULL;
}
