/* handoff.c - see handoff.h
 *
 * A unit can only be finished with the base line above it, its top.  The worker
 * that makes the top sends it straight to the worker that waits for it (the
 * coordinator says to whom: NEXT_HOLDER), and a copy to the coordinator.  The
 * copy serves a worker that gets the unit later, and a worker that its link has
 * failed: a waiting attempt gets the copy when the top has been here for
 * LINK_MS.  Facts are kept until their line is done, and sent to all workers
 * that have the line or get it.  So no pixel is traced twice when a worker is
 * lost or gives lines away; a twin traces again what its unit's other worker
 * has not told, for that worker may hang. */
#include "config.h"

#include "lines/handoff.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "desk/linking.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "jobs/attempt.h"
#include "jobs/part.h"
#include "jobs/shared.h"
#include "lines/lending.h"

#include <string.h>

/* Time for a link between two workers to bring the top, and for an attempt to
 * make the top of its unit. */
#define LINK_MS       100
#define TOP_UNMADE_MS 5000

/* Set [*first, *last) to the lines of a unit; returns its frame. */
static uint32_t
lines_of_unit(const struct job *job, uint32_t unit, uint32_t *first,
              uint32_t *last)
{
    struct partition_area a;

    partition_area(job->partition, unit, &a);
    partition_unit_lines(job->partition, unit, first, last);
    return a.frame;
}

/* The unit that has the line; PARTITION_NONE: no unit, or no such line. */
static uint32_t
unit_at(const struct job *job, uint32_t frame, uint32_t line)
{
    return line < partition_lines(job->partition, frame)
               ? partition_line_unit(job->partition, frame, line)
               : PARTITION_NONE;
}

static uint64_t
conn_of(const struct job *job, const struct job_attempt *attempt)
{
    return job->parts[attempt->part].worker->conn;
}

/* --- out --- */

/* The first bar of a unit cannot be traced ahead without the colours of the
 * base line above.  Another worker that has that line sends them early, for
 * workers make base lines first; in a static partition some worker always has
 * the line, or will get it soon.  Else this unit's worker makes the base line,
 * too (MSG_UNIT_TOP), and no other worker gets the line above until it is made.
 */
uint8_t
handoff_flags(struct job *job, struct job_attempt *attempt)
{
    uint32_t first, last;
    uint32_t frame = lines_of_unit(job, attempt->unit, &first, &last);

    if (first == 0 || partition_kind(job->partition) == MSG_PART_STATIC ||
        unit_at(job, frame, first - 1) != PARTITION_NONE)
        return 0;
    attempt->handoff.makes_top = true;
    partition_keep_line(job->partition, frame, first - 1, true);
    return MSG_UNIT_TOP;
}

/* Is that line the top of the attempt's unit, which the attempt makes? */
static bool
is_making_top(const struct job *job, const struct job_attempt *attempt,
              uint32_t frame, uint32_t line)
{
    uint32_t first, last;

    return attempt->handoff.makes_top &&
           lines_of_unit(job, attempt->unit, &first, &last) == frame &&
           first == line + 1;
}

static void
send_facts(struct coord *c, const struct job *job, uint32_t frame,
           uint32_t line, const struct job_attempt *attempt)
{
    const struct shared_facts *at = NULL;
    struct msg m = { .type = MSG_FACTS };

    while (shared_get_facts(job->shared, frame, line, &at, &m.facts)) {
        m.facts.job = job->id;
        actions_send(&c->actions, conn_of(job, attempt), &m);
    }
}

/* A unit without its top, whose lines begin with `first', begins on the guess
 * at the densities above the line of its top. */
static void
send_guess(struct coord *c, const struct job *job, uint32_t frame,
           uint32_t first, const struct job_attempt *attempt)
{
    struct msg m = { .type = MSG_GUESS };

    if (first < 2 || !shared_get_guess(job->shared, frame, first - 2, &m.guess))
        return;
    m.guess.job = job->id;
    actions_send(&c->actions, conn_of(job, attempt), &m);
}

/* Send the attempt what is here of a base line, and note if that is all. */
static void
send_base(struct coord *c, struct job *job, uint32_t frame, uint32_t line,
          struct job_attempt *attempt)
{
    uint32_t x = 0, first = 0;
    struct msg m = { .type = MSG_BASE_LINE };

    while (
        shared_get_base(job->shared, frame, line, &x, &first, &m.base_line)) {
        m.base_line.job = job->id;
        actions_send(&c->actions, conn_of(job, attempt), &m);
        if (c->actions.n > 0)
            job->base_line_bytes += c->actions.v[c->actions.n - 1].len;
    }
    attempt->handoff.top_sent = shared_whole_ms(job->shared, frame, line) != 0;
}

/* Tell the workers of the unit above which worker waits for the unit's bottom.
 */
static void
send_next_holder(struct coord *c, struct job *job, uint32_t above,
                 uint32_t frame, uint32_t line, const struct job_attempt *below)
{
    const struct job_unit *u = &job->units[above];
    struct msg m = { .type = MSG_NEXT_HOLDER,
                     .next_holder = { job->id, frame, line,
                                      job->parts[below->part].name } };

    for (uint8_t i = 0; i < u->nattempts; i++) {
        if (u->attempts[i].origin == ATTEMPT_LOAN)
            continue;
        linking_need(c, job, u->attempts[i].part, below->part);
        actions_send(&c->actions, conn_of(job, &u->attempts[i]), &m);
    }
}

/* An attempt begins: tell the workers of the unit above of it, and its worker
 * of the unit below, and link them. */
static void
introduce(struct coord *c, struct job *job, const struct job_attempt *attempt)
{
    uint32_t first, last, other;
    uint32_t frame = lines_of_unit(job, attempt->unit, &first, &last);
    const struct job_attempt *below;

    other = first > 0 ? unit_at(job, frame, first - 1) : PARTITION_NONE;
    if (other != PARTITION_NONE && job->units[attempt->unit].nattempts == 1)
        send_next_holder(c, job, other, frame, first - 1, attempt);
    other = unit_at(job, frame, last);
    below = other != PARTITION_NONE ? attempt_first(job, other) : NULL;
    if (below) {
        struct msg m = { .type = MSG_NEXT_HOLDER };

        m.next_holder =
            (struct msg_next_holder){ job->id, frame, last - 1,
                                      job->parts[below->part].name };
        linking_need(c, job, attempt->part, below->part);
        actions_send(&c->actions, conn_of(job, attempt), &m);
    }
}

void
handoff_out(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    uint32_t first, last;
    uint32_t frame = lines_of_unit(job, attempt->unit, &first, &last);

    if (first > 0 && shared_whole_ms(job->shared, frame, first - 1) == 0) {
        send_facts(c, job, frame, first - 1, attempt);
        send_guess(c, job, frame, first, attempt);
    }
    for (uint32_t i = first; i < last; i++)
        send_facts(c, job, frame, i, attempt);
    if (first > 0)
        send_base(c, job, frame, first - 1, attempt);
    introduce(c, job, attempt);
}

/* Facts are not sent: the worker's child still has them. */
void
handoff_back(struct coord *c, struct job *job, uint32_t index)
{
    for (uint32_t i = 0; i < job->nout; i++) {
        uint32_t unit = job->out[i], first, last;
        uint32_t frame = lines_of_unit(job, unit, &first, &last);
        struct job_attempt *attempt = attempt_of_part(job, unit, index);

        if (!attempt || attempt->origin != ATTEMPT_RESUMED)
            continue;
        if (first > 0)
            send_base(c, job, frame, first - 1, attempt);
        introduce(c, job, attempt);
    }
}

/* --- in --- */

/* Does another worker's attempt at a unit still trace on a guess at its top? */
static bool
is_guessing(const struct job_attempt *attempt, uint32_t from)
{
    return attempt->part != from && !attempt->handoff.top_sent &&
           attempt->origin != ATTEMPT_LOAN;
}

/* Facts of a unit's bottom line are a guess at the top of the unit below: with
 * them the first bar below can be traced ahead.  Send them to its workers. */
static void
pass_below(struct coord *c, const struct job *job, uint32_t from,
           const struct msg *pass)
{
    const struct msg_facts *m = &pass->facts;
    uint32_t below = unit_at(job, m->frame, m->line + 1), first, last;
    const struct job_unit *u;

    if (below == PARTITION_NONE || !shared_of_base(job->shared, m))
        return;
    partition_unit_lines(job->partition, below, &first, &last);
    u = &job->units[below];
    for (uint8_t i = 0; i < u->nattempts && first == m->line + 1; i++)
        if (is_guessing(&u->attempts[i], from))
            actions_send(&c->actions, conn_of(job, &u->attempts[i]), pass);
}

/* Can the attempt use facts of the line?  A loan cannot. */
static bool
wants(const struct job *job, const struct job_attempt *attempt, uint32_t line)
{
    uint32_t first, last;

    partition_unit_lines(job->partition, attempt->unit, &first, &last);
    return attempt->origin != ATTEMPT_LOAN && line + 1 >= first && line < last;
}

/* Send facts on to the other workers that have the line now. */
static void
pass_on(struct coord *c, const struct job *job, uint32_t from,
        const struct msg_facts *m)
{
    uint32_t unit = unit_at(job, m->frame, m->line);
    const struct job_unit *u;
    struct msg pass = { .type = MSG_FACTS, .facts = *m };

    if (unit == PARTITION_NONE)
        return;
    u = &job->units[unit];
    pass.facts.job = job->id;
    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].part != from && wants(job, &u->attempts[i], m->line))
            actions_send(&c->actions, conn_of(job, &u->attempts[i]), &pass);
    if (attempt_of_part(job, unit, from))
        pass_below(c, job, from, &pass);
}

/* The job that a worker's message about lines is for; NULL: ignore the message.
 */
static struct job *
job_with_lines(struct coord *c, struct coord_worker *w, const uint8_t *id,
               uint32_t *index)
{
    struct job *job = desk_job_of(c, w, id, index);

    if (!job || !job->shared || !part_is_here(&job->parts[*index]))
        return NULL;
    return job;
}

/* Facts came of a line that is in no unit: if they are the base line that an
 * attempt at the unit below makes as its top, that top is made. */
static void
top_facts(struct coord *c, struct job *job, uint32_t index,
          const struct msg_facts *m)
{
    uint32_t below = unit_at(job, m->frame, m->line + 1);
    struct job_attempt *attempt =
        below != PARTITION_NONE ? attempt_of_part(job, below, index) : NULL;

    if (attempt && is_making_top(job, attempt, m->frame, m->line) &&
        shared_of_base(job->shared, m))
        holding_top_made(c, job, attempt);
}

void
handoff_facts(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_facts *m = &msg->facts;
    uint32_t index, unit;
    struct job *job = job_with_lines(c, w, m->job, &index);

    if (!job)
        return;
    if (!shared_facts_fit(job->shared, m)) {
        verdict_break(c, w->conn, "FACTS that fit no line");
        return;
    }
    unit = unit_at(job, m->frame, m->line);
    if (unit != PARTITION_NONE && job->units[unit].state == UNIT_DONE) {
        if (!(m->flags & MSG_FACTS_ESTIMATE))
            job->late_rays += m->npixels;
        return;
    }
    job->late_rays += shared_put_facts(job->shared, m);
    pass_on(c, job, index, m);
    if (unit == PARTITION_NONE)
        top_facts(c, job, index, m);
}

/* The worker of a unit guesses at the densities above its last line. */
void
handoff_guess(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_guess *m = &msg->guess;
    uint32_t index, unit, below;
    struct job *job = job_with_lines(c, w, m->job, &index);
    const struct job_unit *u;

    if (!job)
        return;
    if (!shared_guess_fits(job->shared, m)) {
        verdict_break(c, w->conn, "a GUESS that fits no line");
        return;
    }
    unit = unit_at(job, m->frame, m->line + 1);
    if (unit == PARTITION_NONE || !attempt_of_part(job, unit, index) ||
        !shared_put_guess(job->shared, m))
        return;
    below = unit_at(job, m->frame, m->line + 2);
    if (below == PARTITION_NONE || below == unit)
        return;
    u = &job->units[below];
    for (uint8_t i = 0; i < u->nattempts; i++)
        if (is_guessing(&u->attempts[i], index))
            send_guess(c, job, m->frame, m->line + 2, &u->attempts[i]);
}

/* Can some worker of the unit above send the attempt its bottom itself? */
static bool
can_link(const struct job *job, const struct job_unit *above,
         const struct job_attempt *below)
{
    const struct coord_worker *b = job->parts[below->part].worker;

    for (uint8_t i = 0; i < above->nattempts; i++) {
        const struct coord_worker *a =
            job->parts[above->attempts[i].part].worker;

        if (a == b || linking_can(a, b))
            return true;
    }
    return false;
}

/* If the top of a unit is here, send it to the attempts that wait for it; but
 * first leave links between workers LINK_MS to bring it. */
static void
offer_top(struct coord *c, struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    uint32_t first, last, above;
    uint32_t frame = lines_of_unit(job, unit, &first, &last);
    uint64_t whole_ms;

    if (first == 0)
        return;
    whole_ms = shared_whole_ms(job->shared, frame, first - 1);
    above = unit_at(job, frame, first - 1);
    if (whole_ms == 0 || above == PARTITION_NONE)
        return;
    for (uint8_t i = 0; i < u->nattempts; i++) {
        struct job_attempt *attempt = &u->attempts[i];

        if (attempt->parked_ms != 0 && attempt->state != ATTEMPT_DELIVERED &&
            !attempt->handoff.top_sent &&
            (c->now_ms - whole_ms >= LINK_MS ||
             !can_link(job, &job->units[above], attempt)))
            send_base(c, job, frame, first - 1, attempt);
    }
}

/* The top of a unit has come.  Attempts that were parked for it have work
 * again: the decisions of the whole unit, and at least part of its first bar.
 */
static void
top_is_here(struct coord *c, struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    offer_top(c, job, unit);
    u->whole = false; /* its lines are gone over again: some can be given away
                       */
    for (uint8_t i = 0; i < u->nattempts; i++)
        if (u->attempts[i].state == ATTEMPT_PARKED)
            holding_step(c, job, &u->attempts[i], ATTEMPT_WORKING);
}

/* May the worker send lines of the unit?  It has an attempt, or had the last
 * and no worker has one now. */
static bool
may_make(const struct job *job, uint32_t unit, uint32_t index)
{
    const struct job_unit *u = &job->units[unit];

    return attempt_of_part(job, unit, index) ||
           (u->nattempts == 0 && u->part == index);
}

void
handoff_base_line(struct coord *c, struct coord_worker *w,
                  const struct msg *msg)
{
    const struct msg_base_line *m = &msg->base_line;
    uint32_t index, unit, below;
    struct job *job = job_with_lines(c, w, m->job, &index);

    if (!job)
        return;
    if (!shared_base_fits(job->shared, m)) {
        verdict_break(c, w->conn, "a BASE_LINE that fits no line");
        return;
    }
    unit = unit_at(job, m->frame, m->line);
    below = unit_at(job, m->frame, m->line + 1);
    if (unit == PARTITION_NONE || !may_make(job, unit, index) ||
        (below != PARTITION_NONE && job->units[below].state == UNIT_DONE))
        return;
    if (m->line + 1 < partition_lines(job->partition, m->frame) &&
        shared_put_base(job->shared, m, c->now_ms) && below != PARTITION_NONE)
        top_is_here(c, job, below);
}

/* Is the top of the unit here, or does it need none? */
static bool
has_top(const struct job *job, uint32_t unit)
{
    uint32_t first, last;
    uint32_t frame = lines_of_unit(job, unit, &first, &last);

    return first == 0 || shared_whole_ms(job->shared, frame, first - 1) != 0;
}

/* Does PARKED tell something new of the attempt?  It waits for its top once;
 * later only for columns that it lent. */
static bool
may_park(const struct job_attempt *attempt)
{
    return attempt->origin != ATTEMPT_LOAN &&
           attempt->state == ATTEMPT_WORKING &&
           (attempt->parked_ms == 0 || attempt->lending.line_ms != 0);
}

void
handoff_parked(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_attempt *m = &msg->parked;
    uint32_t index;
    struct job *job = job_with_lines(c, w, m->job, &index);
    struct job_attempt *attempt;

    if (!job || m->unit >= job->nunits)
        return;
    attempt = attempt_find(job, m->unit, index, m->attempt);
    if (!attempt || !may_park(attempt))
        return;
    desk_log_unit(c, job, attempt, "unit parked");
    holding_top_made(c, job, attempt);
    speed_finished(job, attempt);
    if (lending_parked(c, attempt))
        holding_step(c, job, attempt, ATTEMPT_BLOCKED);
    else if (!has_top(job, m->unit))
        holding_step(c, job, attempt, ATTEMPT_PARKED);
    else
        attempt->parked_ms = c->now_ms; /* its top is on the way to it */
    offer_top(c, job, m->unit);
}

/* --- done --- */

bool
handoff_complete(const struct job *job, uint32_t unit)
{
    uint32_t first, last, frame, below;

    if (!job->shared)
        return true;
    frame = lines_of_unit(job, unit, &first, &last);
    below = unit_at(job, frame, last);
    return last == partition_lines(job->partition, frame) ||
           (below != PARTITION_NONE && job->units[below].state == UNIT_DONE) ||
           shared_whole_ms(job->shared, frame, last - 1) != 0;
}

void
handoff_done(struct job *job, uint32_t unit)
{
    uint32_t first, last;
    uint32_t frame = lines_of_unit(job, unit, &first, &last);

    for (uint32_t i = first; i < last; i++)
        shared_drop_facts(job->shared, frame, i);
    if (first > 0)
        shared_drop_base(job->shared, frame, first - 1);
}

void
handoff_tick(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nout; i++) {
        struct job_unit *u = &job->units[job->out[i]];

        offer_top(c, job, job->out[i]);
        for (uint8_t k = 0; k < u->nattempts; k++)
            if (c->now_ms - u->attempts[k].out_ms >= TOP_UNMADE_MS)
                holding_top_made(c, job, &u->attempts[k]);
    }
}
