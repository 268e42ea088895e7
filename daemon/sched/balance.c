/* balance.c - see balance.h
 *
 * Where a worker is idle and no unit waits, the attempt with the most time left
 * is asked to give away half of the lines that it has not begun (SPLIT); what
 * it gives (GAVE) becomes a new unit, which waits.  An attempt that has no
 * lines to give lends columns (lending.c).  A unit that is very late gets a
 * twin: another worker does all of it, too, before it gets units of other jobs.
 */
#include "config.h"

#include "sched/balance.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "jobs/attempt.h"
#include "jobs/job.h"
#include "lines/lending.h"
#include "sched/handout.h"
#include "sched/loss.h"

/* An attempt with less time left is not asked: the messages cost more [ms]. */
#define LEAST_SPLIT_MS 40

/* A SPLIT is not answered any more after this time: the unit is left whole. */
#define SPLIT_LOST_MS 2000

/* A unit is late when it is out for LATE_MEDIANS times the median time of a
 * unit, but not before the coordinator's lease. */
#define LATE_MEDIANS 10

/* --- splitting --- */

/* Of the attempts that may be asked for lines, the one with the most time left;
 * NULL: none. */
static struct job_attempt *
choose_giver(const struct coord *c, const struct job *job)
{
    struct job_attempt *best = NULL;
    double most = LEAST_SPLIT_MS;

    for (uint32_t i = 0; i < job->nout; i++) {
        const struct job_unit *u = &job->units[job->out[i]];
        struct job_attempt *attempt = attempt_first(job, job->out[i]);
        uint32_t first, last;
        double ms;

        partition_unit_lines(job->partition, job->out[i], &first, &last);
        if (!attempt || u->whole || u->nattempts != 1 ||
            !attempt_works(attempt) || attempt->split_ms != 0 ||
            last - first < 2)
            continue;
        ms = speed_left_ms(c, job, attempt);
        if (ms >= most) {
            most = ms;
            best = attempt;
        }
    }
    return best;
}

/* Mark units whose SPLIT was not answered in time as whole.  Returns how many
 * SPLITs may still be answered. */
static uint32_t
expire_splits(const struct coord *c, struct job *job)
{
    struct attempt_walk walk = attempt_walk(job);
    const struct job_attempt *attempt;
    uint32_t n = 0;

    while ((attempt = attempt_next(job, &walk))) {
        if (attempt->split_ms == 0)
            continue;
        if (c->now_ms - attempt->split_ms < SPLIT_LOST_MS)
            n++;
        else /* an answer that comes after all counts */
            job->units[attempt->unit].whole = true;
    }
    return n;
}

/* Send SPLIT until as many answers are awaited as there are idle workers.
 * Returns the number of idle workers for which no attempt could be asked. */
static uint32_t
ask_for_lines(struct coord *c, struct job *job, uint32_t idle)
{
    uint32_t asked = expire_splits(c, job);
    struct job_attempt *attempt;

    while (asked < idle && (attempt = choose_giver(c, job))) {
        attempt->split_ms = c->now_ms;
        asked++;
        desk_log_unit(c, job, attempt, "unit split");
        desk_send_attempt(c, job, MSG_SPLIT, attempt);
    }
    return asked < idle ? idle - asked : 0;
}

/* Has a worker other than the attempt's the unit? */
static bool
has_twin(const struct job_unit *u, const struct job_attempt *attempt)
{
    for (uint8_t i = 0; i < u->nattempts; i++)
        if (&u->attempts[i] != attempt && u->attempts[i].origin != ATTEMPT_LOAN)
            return true;
    return false;
}

void
balance_gave(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_gave *m = &msg->gave;
    struct partition_area a;
    struct job_unit *u;
    struct job_attempt *attempt;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);

    if (!job || m->unit >= job->nunits)
        return;
    attempt = attempt_find(job, m->unit, index, m->attempt);
    if (!attempt ||
        (attempt->split_ms == 0 && attempt->state != ATTEMPT_YIELDING &&
         attempt->origin != ATTEMPT_RESUMED)) /* asked before it was lost */
        return;
    attempt->split_ms = 0;
    partition_area(job->partition, m->unit, &a);
    u = &job->units[m->unit];
    actions_log(&c->actions, ACT_DEBUG,
                "unit gave job=%s unit=%u attempt=%u height=%u of=%u", job->hex,
                m->unit, m->attempt, m->height, a.height);
    if (m->height == 0) {
        loss_given_back(c, job, attempt);
        return;
    }
    if (m->height == a.height) {
        u->whole = true;
        return;
    }
    if (attempt->lending.loans > 0) /* they are of a line that was given away */
        loss_end_loans(c, job, m->unit, attempt->number);
    if (has_twin(u, attempt)) { /* which has all lines */
        desk_send_attempt(c, job, MSG_REVOKE, attempt);
        loss_of(c, job, attempt);
        return;
    }
    if (!holding_shrink(c, job, attempt, m->height))
        verdict_break(c, w->conn, "a GAVE that fits no lines");
}

/* --- twins --- */

/* Does the attempt take too long?  Not while it waits: for its top, for a loan,
 * which has a time of its own (lending.c), or to give the unit back (yield.c).
 */
static bool
is_slow(const struct coord *c, const struct job *job,
        const struct job_attempt *attempt, uint64_t lease_floor_ms)
{
    const struct coord_worker *w = job->parts[attempt->part].worker;

    return !attempt_waits(attempt) &&
           c->now_ms - attempt->out_ms >=
               (w->hangs ? c->lease_floor_ms : lease_floor_ms);
}

/* Are all attempts at the unit that may still count slow? */
static bool
is_late(const struct coord *c, const struct job *job, uint32_t unit,
        uint64_t lease_floor_ms)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].origin != ATTEMPT_LOAN &&
            u->attempts[i].rows != ATTEMPT_SPENT &&
            (u->attempts[i].state == ATTEMPT_DELIVERED ||
             !is_slow(c, job, &u->attempts[i], lease_floor_ms)))
            return false;
    return true;
}

/* Shall the unit get a twin because it is late? */
static bool
wants_twin(const struct coord *c, const struct job *job, uint32_t unit,
           uint64_t lease_floor_ms)
{
    const struct job_unit *u = &job->units[unit];

    return u->nattempts < JOB_MAX_HOLDERS && u->crashes.n == 0 &&
           is_late(c, job, unit, lease_floor_ms);
}

static uint64_t
lease_of(const struct coord *c, const struct job *job)
{
    uint64_t ms = LATE_MEDIANS * (uint64_t)speed_median_ms(job);

    return ms > c->lease_floor_ms ? ms : c->lease_floor_ms;
}

/* End attempts that have sent all rows and do not count, so that their workers
 * may get the unit again. */
static void
release_spent(struct coord *c, struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    for (uint8_t k = u->nattempts; k-- > 0;)
        if (u->attempts[k].rows == ATTEMPT_SPENT &&
            u->attempts[k].state != ATTEMPT_DELIVERED)
            holding_end(c, job, &u->attempts[k]);
}

/* Note workers that have work and whose progress counter stands still. */
static void
look_at_workers(struct coord *c)
{
    for (struct coord_worker *w = c->workers; w; w = w->next) {
        bool hangs;

        if (w->in_flight == 0)
            w->progressed_ms = c->now_ms;
        hangs = c->now_ms - w->progressed_ms >= c->lease_floor_ms;
        if (hangs && !w->hangs)
            actions_log(&c->actions, ACT_WARN,
                        "worker hangs worker=%s units=%u", w->name,
                        w->in_flight);
        w->hangs = hangs;
    }
}

void
balance_look(struct coord *c)
{
    look_at_workers(c);
    for (size_t k = 0; k < c->nbegun; k++) {
        struct job *job = c->jobs[k];
        uint64_t lease;

        job->late = 0;
        if (job_over(job) || job->nout == 0)
            continue;
        lease = lease_of(c, job);
        for (uint32_t i = 0; i < job->nout; i++)
            if (is_late(c, job, job->out[i], lease)) {
                release_spent(c, job, job->out[i]);
                job->late += wants_twin(c, job, job->out[i], lease);
            }
    }
}

/* Give no further units of the job to workers that have this late unit. */
static void
leave_out(struct job *job, uint32_t unit)
{
    const struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].origin != ATTEMPT_LOAN)
            desk_late(job, u->attempts[i].part, true);
}

bool
balance_give_twin(struct coord *c, struct job *job, uint32_t index)
{
    uint64_t lease = lease_of(c, job), longest = 0;
    const struct job_attempt *late = NULL;

    for (uint32_t i = 0; i < job->nout; i++) {
        const struct job_attempt *first = attempt_first(job, job->out[i]);
        uint64_t ms = first ? c->now_ms - first->out_ms : 0;

        if (ms <= longest || attempt_of_part(job, job->out[i], index) ||
            !wants_twin(c, job, job->out[i], lease))
            continue;
        longest = ms;
        late = first;
    }
    if (!late)
        return false;
    job->late--;
    actions_log(&c->actions, ACT_INFO,
                "unit late job=%s unit=%u worker=%s s=%llu", job->hex,
                late->unit, job->parts[late->part].name,
                (unsigned long long)longest / 1000);
    leave_out(job, late->unit);
    handout_unit(c, job, index, late->unit);
    return true;
}

void
balance_run(struct coord *c)
{
    for (size_t k = 0; k < c->nbegun; k++) {
        struct job *job = c->jobs[k];
        uint32_t idle = 0;

        if (job_over(job) || job->state == JOB_PAUSED || job->survey ||
            !desk_can_balance(job) || job_waiting(job) > 0)
            continue;
        for (uint32_t i = 0; i < job->nparts; i++)
            idle += desk_is_idle(job, i);
        if (idle > 0 && desk_splits(job))
            idle = ask_for_lines(c, job, idle);
        if (idle > 0)
            lending_ask(c, job, idle);
    }
}
