/* seeding.c - see seeding.h */
#include "config.h"

#include "links/seeding.h"

#include "desk/desk.h"
#include "jobs/part.h"

/* A worker that is ready later than the first by more than this would make
 * records which other workers have needed, and made, before. */
#define LATE_MS 500

/* Does the worker take part from the beginning? */
static bool
begins(const struct job *job, uint32_t i)
{
    const struct job_worker *jw = &job->workers[i];

    return part_is_here(jw) && desk_takes_units(jw->worker);
}

void
seeding_begin(struct coord *c, struct job *job)
{
    double all = 0, sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nworkers; i++)
        if (begins(job, i)) {
            all += job->workers[i].speed;
            n++;
        }
    if (n < 2 || !(all > 0) || !(job->spec.flags & MSG_JOB_SHARE))
        return;
    for (uint32_t i = 0; i < job->nworkers; i++) {
        struct job_worker *jw = &job->workers[i];

        if (!begins(job, i))
            continue;
        jw->seed_first = (uint32_t)(sum / all * MSG_SEED_ALL + .5);
        sum += jw->speed;
        jw->seed_last = (uint32_t)(sum / all * MSG_SEED_ALL + .5);
    }
    job->seed_ms = c->now_ms;
}

void
seeding_ready(struct coord *c, struct job *job, uint32_t index)
{
    struct job_worker *jw = &job->workers[index];
    struct msg m = { .type = MSG_SEED,
                     .seed = { job->id, jw->seed_first, jw->seed_last } };

    if (jw->seed_first < jw->seed_last && c->now_ms - job->seed_ms < LATE_MS &&
        !desk_gives_way(job, index)) {
        jw->seeds = true;
        jw->rest_ms = 0;
        actions_send(&c->actions, jw->worker->conn, &m);
    }
    jw->seed_first = jw->seed_last = 0;
}
