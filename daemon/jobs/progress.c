/* progress.c - see progress.h */
#include "config.h"

#include "jobs/progress.h"

#include "base/list.h"
#include "jobs/job.h"
#include "machine/sums.h"

#include <math.h>
#include <string.h>

#define PACE_S 1. /* the least time from look to look */

/* So many seconds of workers and so large a share tell how long the rest takes,
 * once the first part of that share was at most so many times as dear as the
 * second, or the other way round. */
#define ENOUGH_S 3.
#define ENOUGH   .02
#define STEADY   2.5

/* The first part.  The second foretells the rest: a job begins dear where an
 * ambient cache fills, and cheap where its picture begins with sky. */
#define FIRST_PART .6

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

    for (uint32_t i = 0; i < job->nparts; i++) {
        const struct job_part *part = &job->parts[i];

        rays += part->tally.dropped.rays + part->past.dropped.rays;
        if (part->state != PART_READY)
            continue;
        rays += part->tally.rays_under_way;
        pixels = add_up_to(pixels, part->tally.pixels_under_way, most);
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
    return job->cost_total / (1 - job->filled.share);
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

/* The look that parts what was done since the first look: of looks at the same
 * share the first, for a unit is seen when it is done. */
static const struct progress_look *
parting_look(const struct progress_pace *p)
{
    const struct progress_look *look = p->look, *last = &look[p->nlooks - 1];
    double most = look->share + FIRST_PART * (last->share - look->share);
    uint32_t part = 0;

    for (uint32_t i = 1; i < p->nlooks && look[i].share <= most; i++)
        if (look[i].share > look[part].share)
            part = i;
    return &look[part];
}

/* Seconds of a worker for all of the job, as it went between two looks. */
static double
work_for_all(const struct progress_look *from, const struct progress_look *to)
{
    return (to->work_s - from->work_s) / (to->share - from->share);
}

/* Is enough done, and were both parts of it about as dear? */
static bool
is_steady(const struct progress_pace *p)
{
    const struct progress_look *first = p->look, *part = parting_look(p);
    const struct progress_look *last = &p->look[p->nlooks - 1];
    double before, after;

    if (last->work_s < ENOUGH_S || !(last->share - first->share >= ENOUGH) ||
        !(part->share > first->share))
        return false;
    before = work_for_all(first, part);
    after = work_for_all(part, last);
    return before < STEADY * after && after < STEADY * before;
}

/* Are the options of the job's pictures yet to be found? */
static bool
is_choosing(const struct job *job)
{
    return msg_has_goal(&job->spec) && job->goal.state == GOAL_AHEAD;
}

/* Seconds by the job's --time; 0: it has none, or may end before.  With --error
 * nobody knows how many stages are to come. */
static double
left_by_clock(const struct job *job, uint64_t now_ms)
{
    double left = job->spec.time_ms / 1e3 - goal_spent_s(job, now_ms);

    return job->spec.error_ppm > 0 ? 0 : fmax(left, 0);
}

/* Seconds that the job will still take with the workers that are at it; 0: not
 * known yet, or no worker is at it. */
static double
left_s(const struct job *job, uint64_t now_ms)
{
    const struct progress_pace *p = &job->pace;
    const struct progress_look *last;

    if (job->state != JOB_RUNNING || job_held(job) || p->workers == 0)
        return 0;
    if (!p->steady)
        return left_by_clock(job, now_ms);
    last = &p->look[p->nlooks - 1];
    return fmax(1 - last->share, 0) * work_for_all(parting_look(p), last) /
           p->workers;
}

void
progress_tell(const struct job *job, uint64_t now_ms, struct msg_progress *p)
{
    uint64_t until = job_over(job) ? job->end_ms : now_ms;

    if (job->place == PLACE_FILED) {
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
        .cost_done = cost_seen(job) +
                     cost_of_all(job) * job->filled.share * job->filled.done,
        .cost_total = cost_of_all(job),
        .rays = job->state == JOB_DONE ? job->rays : job->rays_seen,
        .frames_ready = job->frames_ready,
        .elapsed_s = (double)(until - job->submit_ms) / 1000,
        .left_s = left_s(job, now_ms),
        .nan = job->nan,
        .error = progress_error(job).all,
        .left_out = progress_left_out(job),
        .stage = (uint8_t)job->goal.number,
        .ended = job->goal.state != GOAL_AHEAD,
        .rungs = { job->goal.rungs[0], job->goal.rungs[1] },
        .goal_error = job->goal.error,
    };
    memcpy(p->faults, job->faults, sizeof p->faults);
}

/* Add a look.  Of looks at the same share the first and the last stay; when
 * there is no room every second look is dropped. */
static void
add_look(struct progress_pace *p, struct progress_look look)
{
    uint32_t n = 0;

    if (p->nlooks > 1 && p->look[p->nlooks - 2].share == look.share)
        p->nlooks--;
    if (p->nlooks == N_ELEM(p->look)) {
        for (uint32_t i = 0; i < p->nlooks; i += 2)
            p->look[n++] = p->look[i];
        p->nlooks = n;
    }
    p->look[p->nlooks++] = look;
}

/* Take a look.  A share that shrinks is measured otherwise than before: by
 * estimated costs, or other ones. */
static void
take_look(struct progress_pace *p, double share, double work_s)
{
    const struct progress_look *last =
        p->nlooks > 0 ? &p->look[p->nlooks - 1] : NULL;

    if (last && share >= last->share) {
        add_look(p, (struct progress_look){ share, last->work_s + work_s });
    } else {
        p->look[0] = (struct progress_look){ share, 0 };
        p->nlooks = 1;
        p->steady = false;
    }
    p->steady = p->steady || is_steady(p);
}

void
progress_pace(struct job *job, uint64_t now_ms, uint32_t workers)
{
    struct progress_pace *p = &job->pace;
    double dt_s = (double)(now_ms - p->look_ms) / 1000;
    struct msg_progress now;

    if (p->look_ms > 0 && workers == p->workers && dt_s < PACE_S)
        return;
    if (!is_choosing(job)) { /* else the share is no measure of the work */
        progress_tell(job, now_ms, &now);
        take_look(p, msg_progress_share(&now), dt_s * p->workers);
    }
    p->look_ms = now_ms;
    p->workers = workers;
}
