/* frame.c - see frame.h */
#include "config.h"

#include "jobs/frame.h"

#include "jobs/job.h"
#include "machine/steps.h"

#include <stdlib.h>

const struct steps frame_steps = {
    FRAME_STATES,
    {
        [FRAME_OPEN] = { "open", STEP(FRAME_WRITING) | STEP(FRAME_WRITTEN) |
                                     STEP(FRAME_FETCHED) },
        [FRAME_WRITING] = { "writing", STEP(FRAME_WRITTEN) },
        [FRAME_WRITTEN] = { "written", STEP(FRAME_FETCHED) },
        [FRAME_FETCHED] = { "fetched", 0 },
    },
};

void
frame_step(struct job_frame *f, enum frame_state to)
{
    f->state = (enum frame_state)steps_take(&frame_steps, f->state, to);
}

bool
frame_is_written(const struct job_frame *f)
{
    return f->state >= FRAME_WRITTEN;
}

void
frame_count_ready(struct job *job)
{
    while (job->frames_ready < job->spec.nframes &&
           frame_is_written(&job->frames[job->frames_ready]))
        job->frames_ready++;
}

void
frame_add_costs(struct job *job, const struct msg_line_costs *m)
{
    struct job_frame *f;
    uint32_t n;

    if (!job->shared || m->frame >= job->spec.nframes)
        return;
    n = shared_nlines(job->shared, m->frame);
    if (m->nlines > n || m->line > n - m->nlines)
        return;
    f = &job->frames[m->frame];
    if (!f->line_s)
        f->line_s = calloc(n, sizeof *f->line_s);
    f->nlines = n;
    for (uint32_t i = 0; f->line_s && i < m->nlines; i++)
        f->line_s[m->line + i] += 1e-9 * (double)m->cpu_ns[i];
}
