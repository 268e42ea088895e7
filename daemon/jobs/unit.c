/* unit.c - see unit.h
 *
 *               lost, or given back
 *              .---------------------.
 *              v                     |
 *     new -> WAITING -- goes out --> OUT -- its rows are kept --> DONE
 *              |                    ^   |                          ^
 *              |          goes out  |   |  a child died of it      |
 *              |                    |   v                          |
 *              |                   SUSPECT                         |
 *              '-------- recovered with all its rows --------------'
 *
 * A unit that is OUT has attempts (attempt.c), but for the moment after its
 * last attempt ended.  A unit may be lost while its last rows are on their way
 * to the disk: when all are kept it is taken out of its queue again, and is
 * DONE.
 */
#include "config.h"

#include "jobs/unit.h"

#include "jobs/job.h"
#include "jobs/part.h"
#include "machine/steps.h"

#include "base/list.h"

#include <string.h>

const struct steps unit_steps = {
    UNIT_STATES,
    {
        [UNIT_WAITING] = { "waiting", STEP(UNIT_OUT) | STEP(UNIT_DONE) },
        [UNIT_SUSPECT] = { "suspect", STEP(UNIT_OUT) },
        [UNIT_OUT] = { "out", STEP(UNIT_WAITING) | STEP(UNIT_SUSPECT) |
                                  STEP(UNIT_DONE) },
        [UNIT_DONE] = { "done", 0 },
    },
};

void
unit_step(struct job_unit *u, enum unit_state to)
{
    u->state = (enum unit_state)steps_take(&unit_steps, u->state, to);
}

uint32_t
unit_first_attempt(const struct job *job)
{
    return job->lives << 16;
}

bool
unit_grow(struct job *job)
{
    struct job_unit *u;

    for (; job->nunits < partition_total(job->partition); job->nunits++) {
        if (!rad_list_grow(&job->units, job->nunits, sizeof *u))
            return false;
        u = &job->units[job->nunits];
        memset(u, 0, sizeof *u);
        u->part = JOB_NOBODY;
        u->latest = unit_first_attempt(job);
    }
    return true;
}

static bool
add_suspect(struct job *job, uint32_t unit)
{
    if (!rad_list_grow(&job->suspects, job->nsuspects, sizeof *job->suspects))
        return false;
    job->suspects[job->nsuspects++] = unit;
    return true;
}

static void
remove_suspect(struct job *job, uint32_t unit)
{
    uint32_t i = 0;

    while (job->suspects[i] != unit)
        i++;
    job->suspects[i] = job->suspects[--job->nsuspects];
}

void
unit_take(struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    if (u->state == UNIT_SUSPECT)
        remove_suspect(job, unit);
    else
        partition_take(job->partition, unit);
    unit_step(u, UNIT_OUT);
}

void
unit_wait(struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    if (u->crashes.n > 0 && add_suspect(job, unit)) {
        unit_step(u, UNIT_SUSPECT);
        return;
    }
    partition_lost(job->partition, unit);
    unit_step(u, UNIT_WAITING);
}

bool
unit_crashed(struct unit_crashes *crashes, uint32_t index)
{
    if (crashes->n++ == 0)
        crashes->worker = index;
    return crashes->worker == index && crashes->n < JOB_MAX_CRASHES;
}

void
unit_done(struct job *job, uint32_t unit, uint64_t end_ms)
{
    struct job_unit *u = &job->units[unit];
    struct job_part *part = &job->parts[u->part];
    struct partition_area a;

    partition_area(job->partition, unit, &a);
    partition_done(job->partition, unit);
    unit_step(u, UNIT_DONE);
    u->end_ms = end_ms;
    if (end_ms > job->last_ms)
        job->last_ms = end_ms;
    part->units++;
    part->setbacks = 0;
    part->rays += u->counts.rays - u->lent.rays;
    part->cpu_s += u->counts.cpu_s - u->lent.cpu_s;
    job->rays += u->counts.rays - u->lent.rays;
    u->counts.nan.frame = job->spec.frames[a.frame].number;
    msg_nan_add(&job->nan, &u->counts.nan);
    msg_faults_add(job->faults, u->counts.faults);
    msg_doubt_add(&job->doubt, &u->counts.doubt);
    job->units_done++;
    job->cost_done += partition_cost(job->partition, unit);
    job->frames[a.frame].pixels_left -= (uint64_t)a.width * a.height;
}
