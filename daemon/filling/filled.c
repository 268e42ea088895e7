/* filled.c - see filled.h */
#include "config.h"

#include "filling/filled.h"

#include "jobs/progress.h"
#include "machine/jobtext.h"
#include "passes/passcost.h"
#include "filling/stages.h"

#include <math.h>
#include <stdlib.h>

void
filled_begin(struct job *job, const struct rad_pass_size *size)
{
    struct rad_params params;

    if (jobtext_params(job->spec.params, &params, NULL) == 0)
        job->filled.share = rad_passcost_part(&params, size, job->spec.nframes,
                                              job->spec.flags & MSG_JOB_REUSE);
}

void
filled_note(struct job *job, double done, bool all)
{
    if (msg_has_goal(&job->spec))
        done = 1 - (1 - done / 2) * pow(.5, job->goal.number);
    if (all)
        done = 1;
    if (done > job->filled.done)
        job->filled.done = done;
}

void
filled_restore(struct job *job)
{
    struct rad_pass_size *size;

    if (!(job->spec.flags & MSG_JOB_PASSES) || !job->first_ms)
        return;
    size = stages_sizes(&job->spec);
    if (size)
        filled_begin(job, size);
    filled_note(job, 1, true);
    free(size);
}
