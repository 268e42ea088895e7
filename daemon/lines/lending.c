/* lending.c - see lending.h
 *
 * Of the attempts that can give no whole lines away, the one with the most time
 * left lends columns of its last line (LEND, LOAN).  The borrower traces only
 * these columns, and may lend some of them on.  The lender holds back the rows
 * of the line until the columns are its own again (BACK): when the borrower has
 * done them (PAID), is lost or is late.  So no pixel is traced twice, but for
 * those of a loan that is late. */
#include "config.h"

#include "lines/lending.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "jobs/attempt.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "jobs/shared.h"

#include <math.h>
#include <string.h>

/* An attempt with less time left is not asked: the messages cost more [ms]. */
#define LEAST_LOAN_MS 10

/* A worker that can lend at once answers LEND within this time [ms]. */
#define LEND_MS 5

/* A loan that its lender waits for is late after LATE_LOANS times its expected
 * time and LATE_LOAN_MS more; after UNKNOWN_LOAN_MS if nothing is expected. */
#define LATE_LOANS      3
#define LATE_LOAN_MS    400
#define UNKNOWN_LOAN_MS 3000

static double
thread_speed(const struct job *job, uint32_t index)
{
    const struct job_part *part = &job->parts[index];

    return part->speed / (part->threads ? part->threads : 1);
}

/* Time that a thread of the worker takes for a line of the unit [ms]; 0: not
 * known. */
static double
line_time(const struct job *job, uint32_t unit, uint32_t index)
{
    double speed = job->speed.pace * thread_speed(job, index);
    uint32_t first, last;

    partition_unit_lines(job->partition, unit, &first, &last);
    if (!(speed > 0))
        return 0;
    return partition_cost(job->partition, unit) / (last - first) / speed;
}

/* Time that the attempt still needs for the line that it would lend of [ms].  A
 * line that has taken longer than expected may take as long again. */
static double
lendable_ms(const struct coord *c, const struct job *job,
            const struct job_attempt *attempt)
{
    double ms;

    if (attempt->lending.line_ms == 0)
        return speed_left_ms(c, job, attempt);
    ms = attempt->lending.line_left *
         line_time(job, attempt->unit, attempt->part);
    return fabs(ms - (double)(c->now_ms - attempt->lending.line_ms));
}

/* May the attempt be asked to lend?  Not if it can give whole lines away. */
static bool
may_lend(const struct job *job, const struct job_attempt *attempt)
{
    const struct job_unit *u = &job->units[attempt->unit];
    uint32_t first, last;

    partition_unit_lines(job->partition, attempt->unit, &first, &last);
    return u->crashes.n == 0 && u->nattempts < JOB_MAX_ATTEMPTS - 1 &&
           attempt_works(attempt) && attempt->split_ms == 0 &&
           attempt->lending.asked_ms == 0 && attempt->lending.blocked_ms == 0 &&
           (u->whole || last - first == 1 || !desk_splits(job));
}

/* Of the attempts that may lend, the one with the most time left; NULL: none.
 */
static struct job_attempt *
choose_lender(const struct coord *c, const struct job *job)
{
    struct attempt_walk walk = attempt_walk(job);
    struct job_attempt *attempt, *best = NULL;
    double most = 0;

    while ((attempt = attempt_next(job, &walk))) {
        double ms = may_lend(job, attempt) ? lendable_ms(c, job, attempt) : 0;

        if (ms >= LEAST_LOAN_MS && ms > most) {
            most = ms;
            best = attempt;
        }
    }
    return best;
}

/* LENDs whose answer is still expected.  A worker that cannot lend at once may
 * answer later than that. */
static uint32_t
count_lending(const struct coord *c, const struct job *job)
{
    struct attempt_walk walk = attempt_walk(job);
    const struct job_attempt *attempt;
    uint32_t n = 0;

    while ((attempt = attempt_next(job, &walk)))
        n += attempt->lending.asked_ms != 0 &&
             c->now_ms - attempt->lending.asked_ms < LEND_MS;
    return n;
}

/* An idle worker without an attempt at the unit; JOB_NOBODY: none.  Any idle
 * worker if unit is PARTITION_NONE. */
static uint32_t
idle_for(const struct job *job, uint32_t unit)
{
    for (uint32_t i = 0; i < job->nparts; i++)
        if (desk_is_idle(job, i) &&
            (unit == PARTITION_NONE || !attempt_of_part(job, unit, i)))
            return i;
    return JOB_NOBODY;
}

void
lending_ask(struct coord *c, struct job *job, uint32_t idle)
{
    uint32_t asked = count_lending(c, job);
    uint32_t index = idle_for(job, PARTITION_NONE);
    struct job_attempt *attempt;

    if (index == JOB_NOBODY)
        return;
    while (asked < idle && (attempt = choose_lender(c, job))) {
        double mine = thread_speed(job, index);
        double part = mine / (mine + thread_speed(job, attempt->part));
        struct msg m = { .type = MSG_LEND,
                         .lend = { job->id, attempt->unit, attempt->number,
                                   (uint16_t)(65535 * part) } };

        attempt->lending.asked_ms = c->now_ms;
        asked++;
        desk_log_unit(c, job, attempt, "unit lend");
        actions_send(&c->actions, job->parts[attempt->part].worker->conn, &m);
    }
}

bool
lending_parked(const struct coord *c, struct job_attempt *attempt)
{
    attempt->lending.asked_ms = 0; /* PARKED is its answer: it lends nothing */
    if (attempt->lending.loans > 0 && attempt->lending.blocked_ms == 0)
        attempt->lending.blocked_ms = c->now_ms;
    return attempt->lending.loans > 0;
}

/* Expected time of a loan [ms]; 0: not known.  It follows from the unit's cost,
 * or from the time that the lender took for the rest of the line if that was
 * longer for its length. */
static double
loan_time(const struct job *job, const struct job_attempt *lender,
          const struct job_attempt *loan)
{
    double line = line_time(job, loan->unit, loan->part), took = 0;

    /* line_ms may be after blocked_ms: the attempt may lend again when it has
     * waited for its top, or when LEND and PARKED cross */
    if (lender->lending.line_left > 0 &&
        lender->lending.blocked_ms > lender->lending.line_ms)
        took = (double)(lender->lending.blocked_ms - lender->lending.line_ms) /
               lender->lending.line_left * thread_speed(job, lender->part) /
               thread_speed(job, loan->part);
    return loan->lending.line_left * (took > line ? took : line);
}

/* A loan is late if its worker hangs, or if its lender waits for it for too
 * long.  A lender that is to give its unit back does not wait: its loans end
 * with its attempt. */
static bool
is_late_loan(const struct coord *c, const struct job *job,
             const struct job_attempt *loan)
{
    const struct job_attempt *lender =
        attempt_of_number(job, loan->unit, loan->lending.lender);
    double ms = (double)(c->now_ms - loan->out_ms), due;

    if (!lender || job->parts[loan->part].worker->hangs)
        return true;
    if (lender->state != ATTEMPT_BLOCKED)
        return false;
    due = loan_time(job, lender, loan);
    return ms >= (due > 0 ? LATE_LOAN_MS + LATE_LOANS * due : UNKNOWN_LOAN_MS);
}

void
lending_tick(struct coord *c, struct job *job)
{
    struct attempt_walk walk = attempt_walk(job);
    struct job_attempt *attempt;

    while ((attempt = attempt_next(job, &walk))) {
        if (attempt->origin != ATTEMPT_LOAN || !is_late_loan(c, job, attempt))
            continue;
        desk_log_unit(c, job, attempt, "loan late");
        desk_send_attempt(c, job, MSG_REVOKE, attempt);
        holding_end(c, job, attempt);
    }
}

/* Do the columns lie in the unit's last line, and does the attempt have them?
 */
static bool
loan_fits(const struct job *job, const struct job_attempt *attempt,
          const struct msg_loan *m)
{
    struct partition_area a;
    uint32_t first, last;

    partition_area(job->partition, m->unit, &a);
    partition_unit_lines(job->partition, m->unit, &first, &last);
    return m->frame == a.frame && m->line == last - 1 &&
           shared_loan_fits(job->shared, m) &&
           (attempt->origin != ATTEMPT_LOAN ||
            (m->x >= attempt->lending.x &&
             m->x + m->n <= attempt->lending.x + attempt->lending.n));
}

/* May a loan lend these columns on?  Only from its right end, so that what it
 * keeps is one piece.  Any other attempt may. */
static bool
is_whole_end(const struct job_attempt *attempt, const struct msg_loan *m)
{
    return attempt->origin != ATTEMPT_LOAN ||
           (m->n < attempt->lending.n &&
            m->x + m->n == attempt->lending.x + attempt->lending.n);
}

/* Note what part of the line the attempt has now, in units of 1 / 65535. */
static void
note_left(const struct coord *c, struct job_attempt *attempt, unsigned part)
{
    attempt->lending.line_left = part / 65535.;
    attempt->lending.line_ms = c->now_ms;
}

/* Begin a loan of the attempt's columns for an idle worker. */
static void
lend_to(struct coord *c, struct job *job, uint32_t index, uint32_t number,
        const struct msg_loan *m)
{
    struct job_unit *u = &job->units[m->unit];
    struct job_attempt *to =
        holding_begin(c, job, index, m->unit, u->latest + 1);
    struct job_attempt *attempt = attempt_of_number(job, m->unit, number);
    struct msg pass = { .type = MSG_LOAN, .loan = *m };
    uint32_t root =
        attempt->origin == ATTEMPT_LOAN ? attempt->lending.lender : number;

    if (!to) {
        c->actions.failed = true;
        return;
    }
    u->latest++;
    to->origin = ATTEMPT_LOAN;
    to->rows = ATTEMPT_DROPPED;
    to->lending.lender = root;
    to->lending.x = m->x;
    to->lending.n = m->n;
    note_left(c, to, m->given);
    if (attempt->origin == ATTEMPT_LOAN)
        attempt->lending.n -= m->n;
    attempt = attempt_of_number(job, m->unit, root);
    if (attempt)
        attempt->lending.loans++;
    desk_log_unit(c, job, to, "loan out");
    pass.loan.job = job->id;
    pass.loan.attempt = to->number;
    actions_send(&c->actions, job->parts[index].worker->conn, &pass);
}

void
lending_loan(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_loan *m = &msg->loan;
    const struct msg_back back = { m->job,  m->unit, m->attempt,
                                   m->line, m->x,    m->n };
    struct job_attempt *attempt;
    uint32_t index, to;
    struct job *job = desk_job_of(c, w, m->job, &index);

    if (!job || !job->shared || m->unit >= job->nunits)
        return;
    attempt = attempt_find(job, m->unit, index, m->attempt);
    if (!attempt || attempt->state ==
                        ATTEMPT_DELIVERED) { /* no answer: it waits for ever */
        holding_send_back(c, w, &back);
        return;
    }
    if (!loan_fits(job, attempt, m)) {
        verdict_break(c, w->conn, "a LOAN that fits no line");
        return;
    }
    attempt->lending.asked_ms = 0;
    note_left(c, attempt, m->left);
    to = job->units[m->unit].nattempts < JOB_MAX_ATTEMPTS
             ? idle_for(job, m->unit)
             : JOB_NOBODY;
    if (to != JOB_NOBODY && is_whole_end(attempt, m))
        lend_to(c, job, to, attempt->number, m);
    else
        holding_send_back(c, w, &back);
}

/* The borrower's cost is added to the unit's; black pixels (counts.nan) are
 * left out, for the lender makes these again.  If the loan was taken back
 * before PAID came, its cost counts as dropped. */
void
lending_paid(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_paid *m = &msg->paid;
    struct job *job = desk_find_job(c, m->job);
    uint32_t index = job ? desk_index(job, w) : JOB_NOBODY;
    struct msg_counts counts = m->counts;
    struct job_part *part;
    struct job_attempt *attempt;

    if (index == JOB_NOBODY)
        return;
    part = &job->parts[index];
    msg_counts_add(&part->paid, &m->counts);
    attempt = !job_over(job) && m->unit < job->nunits
                  ? attempt_find(job, m->unit, index, m->attempt)
                  : NULL;
    counts.primary_rays = 0; /* the lender counts the pixels that it uses */
    counts.wall_s = 0;       /* it is within the lender's time */
    counts.nan = (struct msg_nan){ 0 };
    if (!attempt || attempt->origin != ATTEMPT_LOAN) {
        memset(counts.faults, 0, sizeof counts.faults);
        msg_counts_add(&part->past.dropped, &counts);
        progress_see(job);
        return;
    }
    desk_log_unit(c, job, attempt, "loan paid");
    desk_late(job, index, false);
    msg_counts_add(&job->units[m->unit].lent, &counts);
    part->rays += counts.rays;
    part->cpu_s += counts.cpu_s;
    job->rays += counts.rays;
    progress_see(job);
    holding_end(c, job, attempt);
}
