/* sched.c - see sched.h
 *
 * A worker has room for one unit a thread where units are small (windows,
 * scanbar), else for one unit, which its threads render together.  While many
 * units wait it has some more at hand, so that no thread waits for the network.
 * Units that wait for their tops take no room.
 *
 * When a worker is lost its unit waits again, at first for this worker alone.
 * Until the unit goes out to another worker, the attempt goes on if the worker
 * comes back, so a connection that breaks for a moment costs nothing.  After
 * that, rows of the earlier attempt are ignored.  Of twins the attempt whose
 * rows come first leads.
 *
 * When a child dies the units that it worked on become suspects.  Each goes out
 * again alone, to another worker if there is one, so that a second crash names
 * the unit that is to blame. */
#include "config.h"

#include "sched/sched.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/linking.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "filling/passes.h"
#include "filling/tiles.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/shared.h"
#include "jobs/unit.h"
#include "sched/balance.h"
#include "sched/handout.h"
#include "sched/survey.h"
#include "sched/turn.h"

#define WORTH_MS 50  /* least time that a unit of auto should take */
#define AWAIT_MS 300 /* busy workers give lines away within this time */

/* If units of a job wait and none is for an idle worker, the job's units count
 * as not for this worker for PASSED_MS (yield.c), then for twice as long, and
 * so on. */
#define PASSED_MS  1000
#define MOST_TIMES 6

/* --- handing out --- */

/* Do so many units wait that, by its share of all speed, the worker would get
 * two more of them for each of its threads? */
static bool
has_plenty(const struct job *job, uint32_t index, uint32_t threads)
{
    double speed = job->parts[index].speed;

    return speed * job_waiting(job) > 2 * threads * job->speed.all;
}

/* Has the worker room for another unit?  Windows: one for each thread, and half
 * as many at hand while many wait.  Lines: one, which all threads share to its
 * last block of columns (team_help.c), and none at hand, for other workers
 * could not share it.
 * Single lines (scanbar): one for each thread, and one at hand, so that no
 * thread waits for the coordinator when a line is done or parked. */
static bool
has_room(const struct job *job, const struct coord_worker *w, uint32_t index)
{
    uint32_t n = w->threads;
    bool few = job_waiting(job) <= job->speed.threads;

    if (!partition_is_strict(job->partition))
        return w->in_flight < (few ? n : n + (n + 1) / 2);
    if (partition_kind(job->partition) != MSG_PART_SCANBAR)
        return w->in_flight == 0;
    return w->in_flight < n + has_plenty(job, index, n);
}

static void
start_job(struct coord *c, struct job *job, struct coord_worker *w)
{
    struct msg m = { .type = MSG_JOB_START, .job_start = job->spec };
    uint32_t i = desk_add_part(c, job, w);

    m.job_start.ncosts = 0; /* costs are for the partition alone */
    if (i == JOB_NOBODY) {
        c->actions.failed = true;
        return;
    }
    part_step(&job->parts[i], PART_LOADING);
    job->parts[i].threads = w->threads;
    w->loading = job;
    if (job->partition)
        partition_set_absent(job->partition, i, false);
    actions_send(&c->actions, w->conn, &m);
}

/* A suspect unit that this worker may try; false: none. */
static bool
find_suspect(const struct coord *c, const struct job *job, uint32_t index,
             uint32_t *unit)
{
    for (uint32_t i = 0; i < job->nsuspects; i++) {
        *unit = job->suspects[i];
        if (desk_may_try(c, job, &job->units[*unit].crashes, index))
            return true;
    }
    return false;
}

/* Shall the worker get no unit until it has none, to take a suspect alone? */
static bool
runs_empty(const struct coord *c, const struct job *job,
           const struct coord_worker *w, uint32_t index)
{
    uint32_t unit;

    return w->in_flight > 0 && find_suspect(c, job, index, &unit);
}

/* The partition's next unit for the worker; false: none. */
static bool
next_unit(struct coord *c, struct job *job, const struct coord_worker *w,
          uint32_t index, uint32_t *unit)
{
    struct partition_ask ask = { .worker = index,
                                 .workers = job_active(job),
                                 .share = 1,
                                 .least = speed_cost(job, index, WORTH_MS),
                                 .idle = w->in_flight == 0 };

    if (job->speed.all > 0)
        ask.share = job->parts[index].speed / job->speed.all;
    if (!partition_next(job->partition, &ask, unit))
        return false;
    if (unit_grow(job))
        return true;
    c->actions.failed = true;
    return false;
}

/* Is the worker late, and another worker of the job is not? */
static bool
is_left_out(const struct job *job, uint32_t index)
{
    bool others = false;

    for (uint32_t i = 0; i < job->nparts && !others; i++)
        others =
            job->parts[i].state == PART_READY && desk_may_take_part(job, i);
    return job->parts[index].late && others;
}

/* Give the worker a unit of the job; false: it gets none now. */
static bool
give_unit(struct coord *c, struct job *job, struct coord_worker *w,
          uint32_t index)
{
    uint32_t unit;

    if (runs_empty(c, job, w, index) || is_left_out(job, index))
        return false;
    if (find_suspect(c, job, index, &unit)) {
        unit_take(job, unit);
        w->alone = true;
    } else if (!has_room(job, w, index) ||
               !next_unit(c, job, w, index, &unit)) {
        return false;
    }
    handout_unit(c, job, index, unit);
    return true;
}

/* Does the worker work for another job, of no lower priority? */
static bool
works_elsewhere(const struct job *job, const struct coord_worker *w,
                uint32_t index)
{
    return (w->fills && w->fills != job &&
            w->fills->spec.priority >= job->spec.priority) ||
           (w->in_flight > job->parts[index].in_flight &&
            w->priority >= job->spec.priority);
}

/* Has the worker units of a job that comes after this one in the present
 * search?  They may leave its tiles no room, so they are not replaced. */
static bool
is_kept_out(const struct coord *c, const struct job *job,
            const struct coord_worker *w)
{
    for (size_t i = 0; i < c->nbegun; i++) {
        const struct job *o = c->jobs[i];

        if (o != job && o->served != c->serving && holding_has_any(o, w))
            return true;
    }
    return false;
}

/* Give the worker a tile, areas or a unit of a job that it has loaded; false:
 * it gets none now.  *done: nor shall it get any of other jobs. */
static bool
serve_job(struct coord *c, struct job *job, struct coord_worker *w,
          uint32_t index, bool *done)
{
    if (passes_open(job) || job->parts[index].lags) {
        /* the next pass may be open in a moment */
        *done = !works_elsewhere(job, w, index) ||
                (is_kept_out(c, job, w) && tiles_has(c, job, index));
        return tiles_give(c, job, index);
    }
    if (job->survey) {
        *done = job->parts[index].surveying > 0;
        return survey_give(c, job, index);
    }
    if (give_unit(c, job, w, index))
        return true;
    if (job->late > 0 && has_room(job, w, index) &&
        !runs_empty(c, job, w, index) && balance_give_twin(c, job, index))
        return true;
    *done = runs_empty(c, job, w, index);
    return !*done && job->filling && tiles_give(c, job, index);
}

/* Shall an idle worker wait for lines of this job that busy workers may give
 * away, before it gets units of jobs with a lower priority? */
static bool
waits_for_lines(const struct coord *c, const struct coord_worker *w,
                const struct job *job)
{
    uint32_t index = desk_index(job, w);

    return index != JOB_NOBODY && job->place == PLACE_OPEN &&
           desk_can_balance(job) && job->parts[index].state == PART_READY &&
           w->in_flight == 0 && c->now_ms - w->free_ms < AWAIT_MS;
}

/* A worker that was away may still work on units of a job that was paused
 * meanwhile, or that worker was drained.  Start the job on it: it names its
 * units (STILL), and gives them back. */
static void
recall(struct coord *c, struct coord_worker *w)
{
    for (size_t i = 0; w->conn != 0 && !w->loading && i < c->nbegun; i++) {
        struct job *job = c->jobs[i];
        uint32_t index = desk_index(job, w);

        if (job_over(job) || index == JOB_NOBODY ||
            job->parts[index].state != PART_GONE ||
            job->parts[index].keep_ms <= c->now_ms)
            continue;
        if (job->state == JOB_PAUSED || !desk_takes_units(w))
            start_job(c, job, w);
    }
}

/* Does the worker estimate a job's areas, or make its tiles, or may it in a
 * moment?  Not while the job's next pass waits for pictures, and all tiles that
 * may be made before that are made. */
static bool
is_at_passes(const struct coord *c, const struct coord_worker *w)
{
    const struct job *job = w->fills;
    uint32_t index = desk_index(job, w);

    if (job->parts[index].surveying > 0)
        return true;
    return job->filling && !desk_idle_job(job) && desk_takes_units(w) &&
           (passes_open(job) || job->parts[index].lags ||
            tiles_has(c, job, index));
}

/* Units of the job wait, and none was for this idle worker. */
static void
note_passed(const struct coord *c, struct job *job, uint32_t index)
{
    struct job_part *part = &job->parts[index];

    if (!job->partition || job_waiting(job) == 0)
        return;
    part->ask_ms = c->now_ms + ((uint64_t)PASSED_MS << part->passed);
    if (part->passed < MOST_TIMES)
        part->passed++;
}

/* Give the worker one unit of the first job that has one.  While it has units
 * of a job, or may yet get some, it gets none of jobs with a lower priority. */
bool
sched_serve(struct coord *c, struct coord_worker *w)
{
    bool done = false, ahead = false;
    int64_t floor; /* jobs of a lower priority give nothing */
    struct job *job;

    recall(c, w);
    if (w->fills && !is_at_passes(c, w))
        holding_fill(w, NULL); /* its threads no longer count for that job */
    if (!desk_takes_units(w) || w->alone || c->full)
        return false;
    turn_begin(c, w);
    floor = w->priority;
    while (!done && (job = turn_next(c, w, !ahead))) {
        uint32_t index = desk_index(job, w);

        job->served = c->serving;
        if (turn_is_new(job, index)) {
            start_job(c, job, w);
            continue;
        }
        if (job->spec.priority >= floor && job->place == PLACE_OPEN &&
            job->parts[index].state == PART_READY) {
            if (serve_job(c, job, w, index, &done))
                return true;
            if (w->in_flight == 0)
                note_passed(c, job, index);
            if (waits_for_lines(c, w, job))
                floor = job->spec.priority;
        }
        ahead |= turn_is_ahead(job, w, index);
    }
    return false;
}

/* End the connection of a worker that leaves and has nothing left to do. */
static void
let_go(struct coord *c, struct coord_worker *w)
{
    struct msg m = { .type = MSG_BYE, .bye = { "drained" } };

    if (w->conn == 0 || !w->leaving || w->in_flight > 0 || w->parked > 0 ||
        w->delivered > 0)
        return;
    actions_send(&c->actions, w->conn, &m);
    verdict_part(c, w->conn, "drained");
}

void
sched_run_for(struct coord *c, struct coord_worker *w)
{
    while (sched_serve(c, w))
        ;
    let_go(c, w);
}

void
sched_run(struct coord *c)
{
    bool gave;

    c->stirred = false;
    do { /* one unit each in turn, so that all workers get some of few units */
        gave = false;
        for (struct coord_worker *w = c->workers; w; w = w->next)
            gave |= sched_serve(c, w);
    } while (gave);
    if (!c->full)
        balance_run(c);
    for (struct coord_worker *w = c->workers; w; w = w->next)
        let_go(c, w);
}

/* --- drained workers --- */

void
sched_drained(struct coord *c, struct coord_worker *w)
{
    for (size_t i = 0; i < c->nbegun; i++) {
        struct job *job = c->jobs[i];
        uint32_t index = desk_index(job, w);

        if (!job_over(job) && job->partition && index != JOB_NOBODY)
            partition_set_absent(job->partition, index,
                                 !desk_may_take_part(job, index));
    }
}

/* --- end --- */

void
sched_job_over(struct coord *c, struct job *job)
{
    speed_keep(c, job);
    while (job->nout > 0)
        holding_end(c, job, job->units[job->out[0]].attempts);
    for (struct coord_worker *w = c->workers; w; w = w->next) {
        uint32_t index = desk_index(job, w);

        if (w->loading == job) { /* the next job must not wait for its files */
            w->loading = NULL;
            actions_add(&c->actions, ACT_DROP_FILES, w->conn);
        }
        if (w->fills == job)
            holding_fill(w, NULL);
        if (index == JOB_NOBODY)
            continue;
        if (part_is_here(&job->parts[index]))
            part_step(&job->parts[index], PART_GONE);
        if (w->conn != 0)
            desk_send_job_end(c, w->conn, job->id);
    }
    passes_free(job->passes);
    job->passes = NULL;
    survey_end(job);
    shared_free(job->shared);
    job->shared = NULL;
    linking_free(job->links);
    job->links = NULL;
}
