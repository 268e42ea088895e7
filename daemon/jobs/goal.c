/* goal.c - see goal.h */
#include "config.h"

#include "jobs/goal.h"

#include "jobs/job.h"

bool
goal_time_up(const struct job *job)
{
    return job->goal.late && job->spec.time_ms > 0;
}

bool
goal_rays_up(const struct job *job)
{
    return job->goal.late && job->spec.time_ms == 0;
}

const char *
goal_options(const struct job *job)
{
    return job->goal.options ? job->goal.options : job->spec.params;
}
