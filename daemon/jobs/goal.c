/* goal.c - see goal.h */
#include "config.h"

#include "jobs/goal.h"

#include "jobs/job.h"

bool
goal_time_up(const struct job *job)
{
    return job->goal.state == GOAL_SHORT && job->spec.time_ms > 0;
}

bool
goal_rays_up(const struct job *job)
{
    return job->goal.state == GOAL_SHORT && job->spec.time_ms == 0;
}

double
goal_spent_s(const struct job *job, uint64_t now_ms)
{
    uint64_t ms = job->goal.spent_ms;

    if (job->first_ms > 0)
        ms += now_ms - job->first_ms;
    return (double)ms / 1000;
}

const char *
goal_options(const struct job *job)
{
    return job->goal.options ? job->goal.options : job->spec.params;
}
