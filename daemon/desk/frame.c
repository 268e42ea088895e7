/* frame.c - see frame.h */
#include "config.h"

#include "desk/frame.h"

#include "desk/job.h"

#include <assert.h>
#include <stdlib.h>

bool
frame_permits(enum frame_state from, enum frame_state to)
{
    return to == from + 1 || (from == FRAME_OPEN && to >= FRAME_WRITTEN);
}

void
frame_step(struct job_frame *f, enum frame_state to)
{
    assert(frame_permits(f->state, to));
    f->state = to;
}

const char *
frame_state_name(enum frame_state state)
{
    static const char *const name[FRAME_STATES] = { "open", "writing",
                                                    "written", "fetched" };

    return name[state];
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
