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
part_step(struct job_part *part, enum part_state to)
{
    part->state = (enum part_state)steps_take(&part_steps, part->state, to);
}

const struct job_part *
part_first(const struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++)
        if (job->parts[i].took_part)
            return &job->parts[i];
    return NULL;
}

bool
part_is_here(const struct job_part *part)
{
    return part->state == PART_LOADING || part->state == PART_READY;
}

uint32_t
part_find(const struct job *job, const char *name)
{
    for (uint32_t i = 0; i < job->nparts; i++)
        if (strcmp(job->parts[i].name, name) == 0)
            return i;
    return JOB_NOBODY;
}

uint32_t
part_add(struct job *job, const char *name)
{
    uint32_t i = part_find(job, name);
    struct job_part *part;

    if (i != JOB_NOBODY)
        return i;
    if (!rad_list_grow(&job->parts, job->nparts, sizeof *part))
        return JOB_NOBODY;
    part = &job->parts[job->nparts];
    memset(part, 0, sizeof *part);
    snprintf(part->name, sizeof part->name, "%s", name);
    return job->nparts++;
}

struct msg_tally
part_tally(const struct job_part *part)
{
    struct msg_tally t = part->past;

    t.ambient_sent += part->tally.ambient_sent;
    t.ambient_received += part->tally.ambient_received;
    t.ambient_redundant += part->tally.ambient_redundant;
    t.bytes_in += part->tally.bytes_in;
    t.bytes_out += part->tally.bytes_out;
    t.base_line_bytes += part->tally.base_line_bytes;
    t.base_line_pixels += part->tally.base_line_pixels;
    t.busy_s += part->tally.busy_s;
    t.wait_base_line_s += part->tally.wait_base_line_s;
    msg_counts_add(&t.dropped, &part->tally.dropped);
    if (part->tally.peak_rss_bytes > t.peak_rss_bytes)
        t.peak_rss_bytes = part->tally.peak_rss_bytes;
    return t;
}

uint64_t
part_rays(const struct job_part *part)
{
    const struct msg_tally *now = &part->tally, *past = &part->past;

    return part->rays + part->surveyed_rays + now->dropped.rays +
           past->dropped.rays;
}

uint64_t
part_under_way(const struct job_part *part)
{
    return part->state == PART_READY ? part->tally.rays_under_way : 0;
}
