/* speed.c - how fast workers are, and how long a unit will take
 *
 * A worker's speed in a job is its rays per ms of work, by the coordinator's
 * clock; until enough rays are known, its threads times their speed in earlier
 * jobs.  Only ratios of speeds matter.  A job's pace is the cost, as its
 * partition has costs, that a speed of 1 works off in a millisecond.
 * Rays are the workers' own counts.  Speeds serve to share work, never to
 * decide that a worker is late, and their ratios are bounded, so that a wrong
 * count costs only time. */
#include "config.h"

#include "desk/speed.h"

#include "desk/desk.h"
#include "jobs/attempt.h"
#include "jobs/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Work after which a worker's rays tell its speed. */
#define ENOUGH_MS 500

/* The least part of a unit that is taken to be left while none of its rows has
 * come. */
#define LEAST_LEFT .25

/* Cost of a unit's base lines, which are made first, over the cost of its bars;
 * measured in the office at night with -ps 4. */
#define LINES_FIRST .75

/* Bound on the ratio of a thread's speed to the mean. */
#define MOST_RATIO 64.0

static double
clamp(double v)
{
    if (!(v > 1 / MOST_RATIO))
        return 1 / MOST_RATIO;
    return v < MOST_RATIO ? v : MOST_RATIO;
}

void
speed_touch(const struct coord *c, struct job_part *part)
{
    uint64_t ms = c->now_ms - part->since_ms;

    if (part->in_flight > 0)
        part->work_ms += ms;
    part->since_ms = c->now_ms;
}

void
speed_finished(struct job *job, struct job_attempt *attempt)
{
    if (attempt->counted)
        return;
    attempt->counted = true;
    job->speed.finished += partition_cost(job->partition, attempt->unit);
}

/* Rays that a thread of the worker traces in a ms of work; 0: not known yet. */
static double
measured(const struct job_part *part)
{
    double rays = (double)part->rays + (double)part->tally.dropped.rays +
                  (double)part->past.dropped.rays;

    if (part->state == PART_READY)
        rays += (double)part->tally.rays_under_way;
    if (part->work_ms < ENOUGH_MS || !(rays > 0) || part->threads == 0)
        return 0;
    return rays / (double)part->work_ms / part->threads;
}

/* The mean of measured() over the workers for which it is known; 0: none. */
static double
mean_measured(const struct job *job)
{
    double sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nparts; i++) {
        double v = measured(&job->parts[i]);

        sum += v;
        n += v > 0;
    }
    return n ? sum / n : 0;
}

/* Cost of the rows that came of units which are not done: early in a job no
 * other cost is known. */
static double
under_way(const struct job *job)
{
    double sum = 0;

    for (uint32_t i = 0; i < job->nout; i++) {
        const struct job_unit *u = &job->units[job->out[i]];
        const struct job_attempt *lead =
            attempt_of_number(job, job->out[i], u->lead);
        struct partition_area a;

        if (u->next_row == 0 || !lead || !attempt_works(lead))
            continue;
        partition_area(job->partition, job->out[i], &a);
        sum += partition_cost(job->partition, job->out[i]) * u->next_row /
               a.height;
    }
    return sum;
}

void
speed_measure(const struct coord *c, struct job *job)
{
    double mean = mean_measured(job), done;

    if (!job->partition)
        return;
    job->speed.all = job->speed.workload = 0;
    job->speed.threads = 0;
    for (uint32_t i = 0; i < job->nparts; i++) {
        struct job_part *part = &job->parts[i];
        double v = measured(part);

        speed_touch(c, part);
        part->speed = part->threads *
                      (v > 0 ? clamp(v / mean) : clamp(part->worker->relative));
        job->speed.workload += (double)part->work_ms * part->speed;
        if (part->state == PART_READY)
            job->speed.threads += part->threads;
        if (part_is_here(part))
            job->speed.all += part->speed;
    }
    done = job->speed.finished + under_way(job);
    if (job->speed.workload > 0 && done > 0)
        job->speed.pace = done / job->speed.workload;
}

void
speed_keep(const struct coord *c, struct job *job)
{
    double mean;

    speed_measure(c, job);
    mean = mean_measured(job);
    for (uint32_t i = 0; i < job->nparts; i++) {
        double v = measured(&job->parts[i]);
        struct coord_worker *w = job->parts[i].worker;

        if (v > 0) /* the mean of old and new, since jobs differ */
            w->relative = clamp((w->relative + v / mean) / 2);
    }
}

double
speed_cost(const struct job *job, uint32_t index, double ms)
{
    return job->speed.pace * job->parts[index].speed * ms;
}

double
speed_left_ms(const struct coord *c, const struct job *job,
              const struct job_attempt *attempt)
{
    const struct job_part *part = &job->parts[attempt->part];
    const struct job_unit *u = &job->units[attempt->unit];
    double cost = partition_cost(job->partition, attempt->unit), rate, ms, past;
    struct partition_area a;
    double done;

    if (job->speed.pace <= 0) /* unknown: any large time, in order of costs */
        return 1e9 * cost / partition_cost_total(job->partition);
    rate = speed_cost(job, attempt->part, 1) /
           (part->in_flight ? part->in_flight : 1);
    ms = cost / rate;
    if (u->lead == attempt->number && u->next_row > 0) {
        /* at the attempt's own pace, since parts of a picture differ */
        partition_area(job->partition, attempt->unit, &a);
        done = (double)u->next_row / a.height;
        return (double)(c->now_ms - attempt->out_ms) * (1 - done) /
               (done + LINES_FIRST);
    }
    /* a unit that is over its time may take as long again, or has waited for
     * another unit of its worker: the time left is never 0 */
    past = fabs(ms - (double)(c->now_ms - attempt->out_ms));
    return past > ms * LEAST_LEFT ? past : ms * LEAST_LEFT;
}

/* Workers that load or are ready have shares by their speeds.  Drained, leaving
 * and late workers have shares only if there are no other workers. */
void
speed_share(struct coord *c, struct job *job)
{
    double *v = calloc(job->nparts, sizeof *v);
    bool others = false;

    speed_measure(c, job);
    for (uint32_t i = 0; i < job->nparts; i++)
        others |= desk_may_take_part(job, i);
    for (uint32_t i = 0; v && i < job->nparts; i++)
        if (part_is_here(&job->parts[i]) &&
            (!others || desk_may_take_part(job, i)))
            v[i] = job->parts[i].speed;
    if (!v || !partition_set_speeds(job->partition, v, job->nparts))
        c->actions.failed = true;
    for (uint32_t i = 0; i < job->nparts; i++)
        partition_set_absent(job->partition, i, !desk_may_take_part(job, i));
    free(v);
}

void
speed_took(struct job *job, uint64_t ms)
{
    job->speed.took_ms[job->speed.ntook++ % JOB_DURATIONS] = (uint32_t)ms;
}

static int
by_number(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

    return (x > y) - (x < y);
}

uint32_t
speed_median_ms(const struct job *job)
{
    uint32_t v[JOB_DURATIONS], n = job->speed.ntook;

    if (n > JOB_DURATIONS)
        n = JOB_DURATIONS;
    if (n == 0)
        return 0;
    memcpy(v, job->speed.took_ms, n * sizeof *v);
    qsort(v, n, sizeof *v, by_number);
    return v[n / 2];
}
