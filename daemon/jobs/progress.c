/* progress.c - see progress.h */
#include "config.h"

#include "jobs/progress.h"

#include "jobs/job.h"
#include "machine/sums.h"

#include <math.h>
#include <string.h>

#define PACE_S 1. /* the least time from look to look */

/* So many seconds of workers and so large a share tell how long the rest takes.
 */
#define ENOUGH_S 3.
#define ENOUGH   .02

/* a + b, but b adds nothing beyond `most`. */
static uint64_t
add_up_to(uint64_t a, uint64_t b, uint64_t most)
{
    uint64_t room = most > a ? most - a : 0;

    return a + (b < room ? b : room);
}

void
progress_see(struct job *job)
{
    uint64_t rays = job->rays, pixels = job->pixels_done;
    uint64_t most = job->pixels_total > 0 ? job->pixels_total - 1 : 0;

    for (uint32_t i = 0; i < job->nworkers; i++) {
        const struct job_worker *w = &job->workers[i];

        rays += w->tally.dropped.rays + w->past.dropped.rays;
        if (w->state != PART_READY)
            continue;
        rays += w->tally.rays_under_way;
        pixels = add_up_to(pixels, w->tally.pixels_under_way, most);
    }
    if (rays > job->rays_seen)
        job->rays_seen = rays;
    if (pixels > job->pixels_seen)
        job->pixels_seen = pixels;
}

/* The cost of the job's units so far: of units that are done or, if that is
 * more, all cost times the share of pixels that were seen. */
static double
cost_seen(const struct job *job)
{
    double share;

    if (job_over(job) || job->pixels_total == 0)
        return job->cost_done;
    share = (double)job->pixels_seen / (double)job->pixels_total;
    return fmax(job->cost_done, share * job->cost_total);
}

/* The cost of the passes and of all units, measured as units' costs are. */
static double
cost_of_all(const struct job *job)
{
    return job->cost_total / (1 - job->lead.part);
}

void
progress_count_tiles(struct job *job, const struct msg_counts *counts)
{
    msg_counts_add(&job->tiled, counts);
    job->rays += counts->rays;
}

struct rad_error_estimate
progress_error(const struct job *job)
{
    struct rad_doubt d = sums_counted(&job->doubt);

    return rad_doubt_error(&d);
}

double
progress_left_out(const struct job *job)
{
    struct rad_doubt d = sums_counted(&job->doubt);

    return rad_doubt_left_out(&d);
}

/* Seconds that the job will still take with the workers that are at it, if each
 * does as much as one did so far; 0: not known yet, or no worker is at it. */
static double
left_s(const struct job *job)
{
    const struct progress_pace *p = &job->pace;
    double gain = p->share - p->first_share;

    if (job->state != JOB_RUNNING || p->workers == 0 || p->work_s < ENOUGH_S ||
        !(gain >= ENOUGH))
        return 0;
    return fmax(1 - p->share, 0) / gain * p->work_s / p->workers;
}

void
progress_tell(const struct job *job, uint64_t now_ms, struct msg_progress *p)
{
    uint64_t until = job_over(job) ? job->end_ms : now_ms;

    if (job->stage == STAGE_FILED) {
        *p = job->last;
        p->job = job->id;
        return;
    }
    *p = (struct msg_progress){
        .job = job->id,
        .state = job_held(job) ? MSG_STATE_HELD : (uint8_t)job->state,
        .pixels_done = job->pixels_done,
        .pixels_total = job->pixels_total,
        .units_done = job->units_done,
        .units_total = job->partition ? partition_total(job->partition) : 0,
        .units_redone = job->units_redone,
        .cost_done =
            cost_seen(job) + cost_of_all(job) * job->lead.part * job->lead.done,
        .cost_total = cost_of_all(job),
        .rays = job->state == JOB_DONE ? job->rays : job->rays_seen,
        .frames_ready = job->frames_ready,
        .elapsed_s = (double)(until - job->submit_ms) / 1000,
        .left_s = left_s(job),
        .nan = job->nan,
        .error = progress_error(job).all,
        .left_out = progress_left_out(job),
        .stage = (uint8_t)job->goal.number,
        .ended = job->goal.ended,
        .rungs = { job->goal.rungs[0], job->goal.rungs[1] },
        .goal_error = job->goal.error,
    };
    memcpy(p->faults, job->faults, sizeof p->faults);
}

void
progress_pace(struct job *job, uint64_t now_ms, uint32_t workers)
{
    struct progress_pace *p = &job->pace;
    double dt_s = (double)(now_ms - p->look_ms) / 1000;
    struct msg_progress now;

    if (p->look_ms > 0 && workers == p->workers && dt_s < PACE_S)
        return;
    progress_tell(job, now_ms, &now);
    p->share = msg_progress_share(&now);
    if (p->look_ms == 0 || p->share < p->first_share) {
        p->first_share = p->share;
        p->work_s = 0;
    } else {
        p->work_s += dt_s * p->workers;
    }
    p->look_ms = now_ms;
    p->workers = workers;
}
