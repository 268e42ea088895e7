/* part.c - see part.h
 *
 *                    JOB_START               READY
 *            GONE -------------> LOADING -------------> READY
 *            ^  ^                |  |  |                |  |
 *            |  '----------------'--|--|----------------'  |
 *            |     its connection or its child is gone     |
 *            |                      |  |                   |
 *            '-- ROOM says so -- NO_ROOM '-> EXCLUDED <----'
 *                or gone
 *
 * When the job is over its workers that are LOADING or READY become GONE. */
#include "config.h"

#include "jobs/part.h"

#include "jobs/job.h"
#include "machine/steps.h"

#include "base/list.h"

#include <stdio.h>
#include <string.h>

const struct steps part_steps = {
    PART_STATES,
    {
        [PART_GONE] = { "gone", STEP(PART_LOADING) },
        [PART_NO_ROOM] = { "no-room", STEP(PART_GONE) },
        [PART_EXCLUDED] = { "excluded", 0 },
        [PART_LOADING] = { "loading", STEP(PART_READY) | STEP(PART_GONE) |
                                          STEP(PART_NO_ROOM) |
                                          STEP(PART_EXCLUDED) },
        [PART_READY] = { "ready", STEP(PART_GONE) | STEP(PART_EXCLUDED) },
    },
};

void
part_step(struct job_worker *jw, enum part_state to)
{
    jw->state = (enum part_state)steps_take(&part_steps, jw->state, to);
}

const struct job_worker *
part_first(const struct job *job)
{
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (job->workers[i].took_part)
            return &job->workers[i];
    return NULL;
}

bool
part_is_here(const struct job_worker *jw)
{
    return jw->state == PART_LOADING || jw->state == PART_READY;
}

uint32_t
part_find(const struct job *job, const char *name)
{
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (strcmp(job->workers[i].name, name) == 0)
            return i;
    return JOB_NOBODY;
}

uint32_t
part_add(struct job *job, const char *name)
{
    uint32_t i = part_find(job, name);
    struct job_worker *w;

    if (i != JOB_NOBODY)
        return i;
    if (!rad_list_grow(&job->workers, job->nworkers, sizeof *w))
        return JOB_NOBODY;
    w = &job->workers[job->nworkers];
    memset(w, 0, sizeof *w);
    snprintf(w->name, sizeof w->name, "%s", name);
    return job->nworkers++;
}

struct msg_tally
part_tally(const struct job_worker *jw)
{
    struct msg_tally t = jw->past;

    t.ambient_sent += jw->tally.ambient_sent;
    t.ambient_received += jw->tally.ambient_received;
    t.ambient_redundant += jw->tally.ambient_redundant;
    t.bytes_in += jw->tally.bytes_in;
    t.bytes_out += jw->tally.bytes_out;
    t.base_line_bytes += jw->tally.base_line_bytes;
    t.base_line_pixels += jw->tally.base_line_pixels;
    t.busy_s += jw->tally.busy_s;
    t.wait_base_line_s += jw->tally.wait_base_line_s;
    msg_counts_add(&t.dropped, &jw->tally.dropped);
    if (jw->tally.peak_rss_bytes > t.peak_rss_bytes)
        t.peak_rss_bytes = jw->tally.peak_rss_bytes;
    return t;
}

uint64_t
part_rays(const struct job_worker *jw)
{
    const struct msg_tally *now = &jw->tally, *past = &jw->past;

    return jw->rays + jw->surveyed_rays + now->dropped.rays +
           past->dropped.rays;
}

uint64_t
part_under_way(const struct job_worker *jw)
{
    return jw->state == PART_READY ? jw->tally.rays_under_way : 0;
}
