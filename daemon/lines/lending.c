/* lending.c - columns of a line for an idle worker
 *
 * The attempt that has the most time left at its last line, and can give no
 * whole lines, lends columns of this line (LEND, LOAN).  The borrower traces
 * these columns alone, and can lend some of them on.  The lender's rows wait
 * for them, so no pixel is traced twice.  When the borrower has done them
 * (PAID), is lost or late, the columns are the lender's again (BACK). */
#include "config.h"

#include "lines/lending.h"

#include "desk/desk.h"
#include "desk/hold.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "jobs/go.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "jobs/shared.h"

#include <math.h>
#include <string.h>

/* Less is not worth the messages [ms of its worker]. */
#define LEAST_LOAN_MS 10

/* A LEND that can be answered at once is answered by then. */
#define LEND_MS 5

/* A loan for which its lender waits is late after LATE_LOAN_MS more than
 * LATE_LOANS times its expected time; after UNKNOWN_LOAN_MS if that time is not
 * known. */
#define LATE_LOANS      3
#define LATE_LOAN_MS    400
#define UNKNOWN_LOAN_MS 3000

/* May columns of a line of the job be lent? */
static bool
lends(const struct job *job)
{
    return partition_kind(job->partition) != MSG_PART_STATIC ||
           !(job->spec.flags & MSG_JOB_NO_BALANCE);
}

static double
thread_speed(const struct job *job, uint32_t index)
{
    const struct job_worker *jw = &job->workers[index];

    return jw->speed / (jw->threads ? jw->threads : 1);
}

/* How long a thread of the worker takes for a line of the unit [ms]; 0: not
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

/* The time that the attempt still needs for the line of which it could lend
 * columns [ms].  A line that has taken longer than expected may well take as
 * long again. */
static double
lendable_ms(const struct coord *c, const struct job *job, uint32_t unit,
            const struct job_go *go)
{
    double ms;

    if (go->lending.line_ms == 0)
        return speed_left_ms(c, job, unit, go);
    ms = go->lending.line_left * line_time(job, unit, go->worker);
    return fabs(ms - (double)(c->now_ms - go->lending.line_ms));
}

/* May the attempt be asked to lend?  Only if it can give no lines. */
static bool
may_lend(const struct job *job, uint32_t unit, const struct job_go *go)
{
    uint32_t first, last;

    partition_unit_lines(job->partition, unit, &first, &last);
    return go_works(go) && go->split_ms == 0 && go->lending.asked_ms == 0 &&
           go->lending.blocked_ms == 0 &&
           (job->units[unit].whole || last - first == 1 || !desk_splits(job));
}

/* The attempt that may lend and has the most time left; NULL: none. */
static struct job_go *
longest(const struct coord *c, const struct job *job, uint32_t *unit)
{
    struct job_go *best = NULL;
    double most = LEAST_LOAN_MS;

    for (uint32_t i = 0; i < job->nout; i++) {
        struct job_unit *u = &job->units[job->out[i]];

        if (u->crashes > 0 || u->ngos >= JOB_MAX_GOES - 1)
            continue;
        for (uint8_t k = 0; k < u->ngos; k++) {
            double ms;

            if (!may_lend(job, job->out[i], &u->go[k]))
                continue;
            ms = lendable_ms(c, job, job->out[i], &u->go[k]);
            if (ms >= most) {
                most = ms;
                best = &u->go[k];
                *unit = job->out[i];
            }
        }
    }
    return best;
}

/* How many LENDs will be answered yet.  An attempt that cannot lend at once
 * does so later. */
static uint32_t
count_lending(const struct coord *c, const struct job *job)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nout; i++) {
        const struct job_unit *u = &job->units[job->out[i]];

        for (uint8_t k = 0; k < u->ngos; k++)
            n += u->go[k].lending.asked_ms != 0 &&
                 c->now_ms - u->go[k].lending.asked_ms < LEND_MS;
    }
    return n;
}

/* An idle worker that may get columns of the unit; JOB_NOBODY: none. */
static uint32_t
idle_for(const struct job *job, uint32_t unit)
{
    for (uint32_t i = 0; i < job->nworkers; i++)
        if (desk_is_idle(job, i) &&
            (unit == PARTITION_NONE || !go_of_worker(job, unit, i)))
            return i;
    return JOB_NOBODY;
}

/* Ask for columns until as many are on their way as workers are idle. */
void
lending_ask(struct coord *c, struct job *job, uint32_t idle)
{
    uint32_t asked = count_lending(c, job), unit = 0;
    uint32_t index = idle_for(job, PARTITION_NONE);
    struct job_go *go;

    if (index == JOB_NOBODY || !lends(job))
        return;
    while (asked < idle && (go = longest(c, job, &unit))) {
        double mine = thread_speed(job, index);
        double part = mine / (mine + thread_speed(job, go->worker));
        struct msg m = { .type = MSG_LEND,
                         .lend = { job->id, unit, go->attempt,
                                   (uint16_t)(65535 * part) } };

        go->lending.asked_ms = c->now_ms;
        asked++;
        desk_log_unit(c, job, unit, go, "unit lend");
        actions_send(&c->actions, job->workers[go->worker].worker->conn, &m);
    }
}

bool
lending_parked(const struct coord *c, struct job_go *go)
{
    go->lending.asked_ms = 0; /* the attempt has no columns to lend */
    if (go->lending.loans > 0 && go->lending.blocked_ms == 0)
        go->lending.blocked_ms = c->now_ms;
    return go->lending.loans > 0;
}

/* The expected time of the loan [ms]: by the cost of the unit, or more if the
 * lender took more for the part of the line that it kept.  0: not known. */
static double
loan_time(const struct job *job, uint32_t unit, const struct job_go *lender,
          const struct job_go *loan)
{
    double line = line_time(job, unit, loan->worker), took = 0;

    /* after a wait for its top, and with LEND and PARKED crossing, the attempt
     * may lend again */
    if (lender->lending.line_left > 0 &&
        lender->lending.blocked_ms > lender->lending.line_ms)
        took = (double)(lender->lending.blocked_ms - lender->lending.line_ms) /
               lender->lending.line_left * thread_speed(job, lender->worker) /
               thread_speed(job, loan->worker);
    return loan->lending.line_left * (took > line ? took : line);
}

/* A loan is late only while its lender waits for it, unless its worker hangs. A
 * lender that is to give its unit back waits no more: its loans end with it. */
static bool
is_late_loan(const struct coord *c, const struct job *job, uint32_t unit,
             const struct job_go *loan)
{
    const struct job_go *lender =
        go_of_attempt(job, unit, loan->lending.lender);
    double ms = (double)(c->now_ms - loan->out_ms), due;

    if (!lender || job->workers[loan->worker].worker->hangs)
        return true;
    if (lender->state != GO_BLOCKED)
        return false;
    due = loan_time(job, unit, lender, loan);
    return ms >= (due > 0 ? LATE_LOAN_MS + LATE_LOANS * due : UNKNOWN_LOAN_MS);
}

void
lending_tick(struct coord *c, struct job *job)
{
    for (uint32_t i = job->nout; i-- > 0;) {
        uint32_t unit = job->out[i];

        for (uint8_t k = job->units[unit].ngos; k-- > 0;) {
            struct job_go *go = &job->units[unit].go[k];

            if (go->origin != GO_LOAN || !is_late_loan(c, job, unit, go))
                continue;
            desk_log_unit(c, job, unit, go, "loan late");
            desk_send_attempt(c, job, MSG_REVOKE, unit, go);
            hold_release(c, job, unit, go);
        }
    }
}

/* Do the columns lie in the unit's last line, and in the lender's? */
static bool
loan_fits(const struct job *job, const struct job_go *go,
          const struct msg_loan *m)
{
    struct partition_area a;
    uint32_t first, last;

    partition_area(job->partition, m->unit, &a);
    partition_unit_lines(job->partition, m->unit, &first, &last);
    return m->frame == a.frame && m->line == last - 1 &&
           shared_loan_fits(job->shared, m) &&
           (go->origin != GO_LOAN ||
            (m->x >= go->lending.x &&
             m->x + m->n <= go->lending.x + go->lending.n));
}

/* A loan is lent on in pieces from its right end, so that each worker has its
 * columns together. */
static bool
is_whole_end(const struct job_go *go, const struct msg_loan *m)
{
    return go->origin != GO_LOAN ||
           (m->n < go->lending.n &&
            m->x + m->n == go->lending.x + go->lending.n);
}

/* Note how much of the line the attempt has now. */
static void
note_left(const struct coord *c, struct job_go *go, unsigned part)
{
    go->lending.line_left = part / 65535.;
    go->lending.line_ms = c->now_ms;
}

/* Columns of an attempt for an idle worker. */
static void
lend_to(struct coord *c, struct job *job, uint32_t index, uint32_t attempt,
        const struct msg_loan *m)
{
    struct job_unit *u = &job->units[m->unit];
    struct job_go *to = hold_add(c, job, index, m->unit, u->attempt + 1);
    struct job_go *go = go_of_attempt(job, m->unit, attempt);
    struct msg pass = { .type = MSG_LOAN, .loan = *m };
    uint32_t root = go->origin == GO_LOAN ? go->lending.lender : attempt;

    if (!to) {
        c->actions.failed = true;
        return;
    }
    u->attempt++;
    to->twin = true;
    to->origin = GO_LOAN;
    to->rows = GO_DROPPED;
    to->lending.lender = root;
    hold_shrunk(job, m->unit, to);
    to->lending.x = m->x;
    to->lending.n = m->n;
    note_left(c, to, m->given);
    if (go->origin == GO_LOAN)
        go->lending.n -= m->n;
    go = go_of_attempt(job, m->unit, root);
    if (go)
        go->lending.loans++;
    desk_log_unit(c, job, m->unit, to, "loan out");
    pass.loan.job = job->id;
    pass.loan.attempt = to->attempt;
    actions_send(&c->actions, job->workers[index].worker->conn, &pass);
}

void
lending_loan(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_loan *m = &msg->loan;
    const struct msg_back back = { m->job,  m->unit, m->attempt,
                                   m->line, m->x,    m->n };
    struct job_go *go;
    uint32_t index, to;
    struct job *job = desk_job_of(c, w, m->job, &index);

    if (!job || !job->shared || m->unit >= job->nunits)
        return;
    go = go_find(job, m->unit, index, m->attempt);
    if (!go ||
        go->state == GO_DELIVERED) { /* else the worker would wait for ever */
        hold_send_back(c, w, &back);
        return;
    }
    if (!loan_fits(job, go, m)) {
        verdict_break(c, w->conn, "a LOAN that fits no line");
        return;
    }
    go->lending.asked_ms = 0;
    note_left(c, go, m->left);
    to = job->units[m->unit].ngos < JOB_MAX_GOES ? idle_for(job, m->unit)
                                                 : JOB_NOBODY;
    if (to != JOB_NOBODY && is_whole_end(go, m))
        lend_to(c, job, to, go->attempt, m);
    else
        hold_send_back(c, w, &back);
}

/* The cost of the loan is added to the unit's, but for black pixels, which the
 * lender makes.  The cost of a loan that was taken back just before is in no
 * unit. */
void
lending_paid(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_paid *m = &msg->paid;
    struct job *job = desk_find_job(c, m->job);
    uint32_t index = job ? desk_index(job, w) : JOB_NOBODY;
    struct msg_counts counts = m->counts;
    struct job_worker *jw;
    struct job_go *go;

    if (index == JOB_NOBODY)
        return;
    jw = &job->workers[index];
    msg_counts_add(&jw->paid, &m->counts);
    go = !job_over(job) && m->unit < job->nunits
             ? go_find(job, m->unit, index, m->attempt)
             : NULL;
    counts.primary_rays = 0; /* counted by the lender, which uses them */
    counts.wall_s = 0;       /* while the unit's own went on */
    counts.nan = (struct msg_nan){ 0 };
    if (!go || go->origin != GO_LOAN) {
        memset(counts.faults, 0, sizeof counts.faults);
        msg_counts_add(&jw->past.dropped, &counts);
        progress_see(job);
        return;
    }
    desk_log_unit(c, job, m->unit, go, "loan paid");
    desk_late(job, index, false);
    msg_counts_add(&job->units[m->unit].lent, &counts);
    jw->rays += counts.rays;
    jw->cpu_s += counts.cpu_s;
    job->rays += counts.rays;
    progress_see(job);
    hold_release(c, job, m->unit, go);
}
