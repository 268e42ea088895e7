/* life.c - see life.h
 *
 * A job, for its users (enum job_state):
 *
 *                .-resume, once a tile or unit was out--.
 *                v                                      |
 *   WAITING --> RUNNING ------------pause----------> PAUSED
 *      ^ |  a unit, a tile or an                       ^ |
 *      | |  estimate goes out                          | |
 *      | '------------------pause----------------------' |
 *      '------------resume, before that------------------'
 *
 *   any of these --a verdict (verdict.h), which is final-->
 *      DONE (all pictures are written), FAILED, CANCELLED
 *
 * How far the store is with it (enum job_place):
 *
 *     ARRIVING --all files are here--> OPENING --no room--> NO_ROOM
 *      |    |                           |   |                |   |
 *      |    |                           |   '---> OPEN <-----'   |
 *      |    '-- restart, goes on -------|-----------^ |          |
 *      |                                |             |          |
 *      |                                '---> KEPT <--+----------'
 *      |                                        |   over, and the store has its
 *      '-- restart, was over ----> FILED <------'   statistics
 *
 * A job that ends before all its files are here stays ARRIVING: the store does
 * not know it. */
#include "config.h"

#include "jobs/life.h"

#include "jobs/job.h"
#include "machine/steps.h"

#define VERDICT (STEP(JOB_DONE) | STEP(JOB_FAILED) | STEP(JOB_CANCELLED))

const struct steps life_states = {
    JOB_STATES,
    {
        [JOB_WAITING] = { "waiting",
                          STEP(JOB_RUNNING) | STEP(JOB_PAUSED) | VERDICT },
        [JOB_RUNNING] = { "running", STEP(JOB_PAUSED) | VERDICT },
        [JOB_PAUSED] = { "paused",
                         STEP(JOB_WAITING) | STEP(JOB_RUNNING) | VERDICT },
        [JOB_DONE] = { "done", 0 },
        [JOB_FAILED] = { "failed", 0 },
        [JOB_CANCELLED] = { "cancelled", 0 },
    },
};

const struct steps life_places = {
    JOB_PLACES,
    {
        [PLACE_ARRIVING] = { "arriving", STEP(PLACE_OPENING) |
                                             STEP(PLACE_OPEN) |
                                             STEP(PLACE_FILED) },
        [PLACE_OPENING] = { "opening", STEP(PLACE_NO_ROOM) | STEP(PLACE_OPEN) |
                                           STEP(PLACE_KEPT) },
        [PLACE_NO_ROOM] = { "no-room", STEP(PLACE_OPEN) | STEP(PLACE_KEPT) },
        [PLACE_OPEN] = { "open", STEP(PLACE_KEPT) },
        [PLACE_KEPT] = { "kept", STEP(PLACE_FILED) },
        [PLACE_FILED] = { "filed", 0 },
    },
};

void
life_step(struct job *job, enum job_state to)
{
    job->state = (enum job_state)steps_take(&life_states, job->state, to);
}

void
life_move(struct job *job, enum job_place to)
{
    job->place = (enum job_place)steps_take(&life_places, job->place, to);
}

void
life_set_running(struct job *job)
{
    if (job->state == JOB_WAITING)
        life_step(job, JOB_RUNNING);
}

void
life_begin(struct job *job, uint64_t now_ms)
{
    if (job->first_ms == 0)
        job->first_ms = now_ms;
    life_set_running(job);
}

void
life_pause(struct job *job)
{
    if (job->state != JOB_PAUSED)
        life_step(job, JOB_PAUSED);
}

void
life_resume(struct job *job)
{
    if (job->state == JOB_PAUSED)
        life_step(job, job->first_ms ? JOB_RUNNING : JOB_WAITING);
}
