/* strict_order.c - orders of the coordinator about units; a unit waits, gives
 * lines away, goes back or ends */
#include "config.h"

#include "strict/strict_order.h"

#include "strict/strict_facts.h"
#include "strict/strict_guess.h"
#include "strict/strict_loan.h"
#include "strict/strict_out.h"
#include "strict/strict_rank.h"
#include "strict/strict_state.h"

/* How long a unit waits for its top before its facts are sent, so that short
 * waits cost no traffic. */
#define PARK_MS 200

/* Time between two looks at a pass under way: other workers may wait for its
 * facts, for a piece of its bottom, or for columns that it can lend. */
#define LOOK_MS 10

/* The line whose first row is `row`, nlines for the height; -1: none. */
static int
line_from_row(const struct frame *f, uint32_t row)
{
    int i = row == 0 ? 0 : (int)((row - 1) / (uint32_t)f->q.ystep) + 1;

    if (row == (uint32_t)f->q.height)
        return f->nlines;
    return i < f->nlines && (uint32_t)row_of(f, i) == row ? i : -1;
}

void
order_drop(struct strict *s, struct strict_unit *u)
{
    strict_unit_leave(s, u);
    if (u->fate != FATE_OVER) {
        msg_counts_add(&s->dropped, &u->spent);
        s->dropped.speculative_rays += facts_untold(s, u);
    }
    out_forget(s, u);
    for (int i = u->first > 0 ? u->first - 1 : 0; i < u->last; i++)
        facts_drop(s, u->frame, i);
    facts_drop_table(s, u->frame);
    strict_unit_free(u);
}

/* Set [*first, *last) to the lines of the message's rows. */
static int
read_lines(const struct strict *s, const struct msg_unit *m, int *first,
           int *last, struct rad_error *err)
{
    const struct frame *f;
    uint32_t end = m->y + m->height;

    if (m->frame >= s->nframes)
        return rad_fail(err, RAD_EPROTO, "unit %u of frame %u, of %u", m->unit,
                        m->frame, s->nframes);
    f = frame_of(s, m->frame);
    if (m->height < 1 || m->y >= (uint32_t)f->q.height || end < m->y ||
        end > (uint32_t)f->q.height || m->x != 0 ||
        m->width != (uint32_t)f->q.width)
        return rad_fail(err, RAD_EPROTO, "unit %u is not within the frame",
                        m->unit);
    *first = line_from_row(f, m->y);
    *last = line_from_row(f, end);
    if (*first < 0 || *last <= *first)
        return rad_fail(err, RAD_EPROTO, "unit %u is no run of lines", m->unit);
    return 0;
}

int
strict_unit(struct strict *s, const struct msg_unit *m, struct rad_error *err)
{
    struct strict_unit *u;
    int first = 0, last = 0, rc;

    if (strict_unit_find(s, m->unit, m->attempt))
        return 0;
    rc = read_lines(s, m, &first, &last, err);
    if (rc < 0)
        return rc;
    u = strict_unit_new(m->unit, m->attempt, m->frame, first, last);
    if (!u)
        return rad_fail_memory(err);
    if (m->flags & MSG_UNIT_TOP && u->first > 0)
        u->above = ABOVE_MADE_HERE;
    strict_unit_enter(s, u);
    facts_use_above(s, u);
    if (u->first > 0 && strict_unit_has_top(s, u)) /* it came before */
        rank_make_way(s);
    return 0;
}

void
strict_revoke(struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = strict_unit_find(s, unit, attempt);

    if (!u)
        return;
    if (u->pass) {
        strict_unit_decide(u, FATE_GONE);
        u->pass->stop = true;
    } else {
        order_drop(s, u);
    }
}

void
order_give_lines(struct strict *s, struct strict_unit *u, int last)
{
    int end = u->last;

    if (last < end) {
        /* the next worker would make the base line above again */
        out_base_facts(s, u, last - 1);
        for (int i = last; i < end; i++)
            out_facts(s, &s->urgent, u, i);
        strict_unit_end_at(s, u, last);
        guess_send(s, u);
        loan_of_other_line(u);
        for (int i = last; i < end; i++)
            facts_drop(s, u->frame, i);
    }
    out_gave(s, u, last < end ? last : end);
}

void
order_split_idle(struct strict *s, struct strict_unit *u)
{
    int from = u->progress >= PROGRESS_AHEAD ? u->last : u->first;

    if (from < u->out) /* rows of these lines are handed on */
        from = u->out;
    if (u->fate == FATE_SPLITS)
        strict_unit_decide(u, FATE_STAYS);
    order_give_lines(s, u, u->last - (u->last - from) / 2);
}

void
order_hand_back(struct strict *s, struct strict_unit *u)
{
    if (u->loan) {
        loan_end(s, u);
    } else {
        for (int i = strict_unit_top(u); i < u->last; i++)
            out_facts(s, &s->urgent, u, i);
        out_line_costs(s, u);
        out_gave(s, u, u->first);
    }
    order_drop(s, u);
}

/* A unit without a pass is given back whole, even if an earlier pass handed on
 * some rows; their facts are sent, too. */
void
strict_yield(struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = strict_unit_find(s, unit, attempt);

    if (!u)
        return;
    if (u->pass) {
        if (u->fate != FATE_YIELDS)
            strict_unit_decide(u, FATE_YIELDS);
        u->pass->stop = true;
    } else {
        order_hand_back(s, u);
    }
}

/* Let the unit give half of its lines away when its pass has ended, or sooner.
 */
static void
want_split(struct strict_unit *u)
{
    if (u->fate != FATE_SPLITS)
        strict_unit_decide(u, FATE_SPLITS);
}

/* Halves are counted in lines without bars.  LINES works on all lines at once,
 * so it ends first, and is made again over its facts. */
void
strict_split(struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = strict_unit_find(s, unit, attempt);

    if (!u || u->loan || u->fate == FATE_YIELDS)
        return;
    if (loan_is_out(u)) { /* its last line is begun: nothing can be given */
        order_give_lines(s, u, u->last);
    } else if (!u->pass) {
        order_split_idle(s, u);
    } else if (u->pass->spec.mode == TEAM_LINES || u->pass->stop) {
        want_split(u);
        u->pass->stop = true;
    } else {
        want_split(u);
        u->pass->split = true;
    }
}

void
strict_shrunk(struct strict *s, struct strict_pass *p, int last)
{
    struct strict_unit *u = p->of;

    p->split = false;
    if (u->fate != FATE_SPLITS)
        return;
    strict_unit_decide(u, FATE_STAYS);
    p->spec.last = last;
    order_give_lines(s, u, last);
    p->sent_columns = u->sent_columns; /* the bottom may be another now */
    p->sent_densities = u->sent_densities;
}

/* Not before the guess has all pixels of the line above: until then no other
 * worker begins that line. */
void
order_say_top(struct strict *s, const struct strict_unit *u)
{
    if (u->above == ABOVE_MADE_HERE && u->progress >= PROGRESS_LINES)
        out_facts(s, &s->urgent, u, u->first - 1);
}

/* Is the unit above at work in this child?  Then the top will come soon. */
static bool
is_near(const struct strict *s, const struct strict_unit *u)
{
    const struct strict_unit *a = strict_unit_above(s, u);

    return a && !rank_waits(s, a);
}

void
order_park(struct strict *s, struct strict_unit *u)
{
    if (is_gone(u) || u->parked || !rank_waits(s, u) ||
        (!u->lending.blocked && is_near(s, u)))
        return;
    u->parked = true;
    loan_nothing_left(u);
    out_state(s, ITEM_PARKED, u);
}

void
order_resume(struct strict *s, struct strict_unit *u)
{
    u->wait.waiting = false;
    u->wait.kept = false; /* the pass may trace more */
    if (u->parked)
        out_state(s, ITEM_RESUMED, u);
    u->parked = false; /* so that PARKED is sent when it waits again */
}

/* Queue the unit's facts in case this worker is lost. */
static void
park_facts(struct strict *s, struct strict_unit *u)
{
    u->wait.kept = true;
    for (int i = u->first; i < u->last; i++)
        out_facts(s, &s->lazy, u, i);
}

/* Shall park_facts() be called when the unit has waited for long? */
static bool
will_keep(const struct strict *s, const struct strict_unit *u)
{
    return u->wait.waiting && u->parked && !u->wait.kept && !is_near(s, u);
}

/* May another worker wait for bottom, facts or columns of the unit's pass? */
static bool
is_awaited(const struct strict *s, const struct strict_unit *u)
{
    bool bottom = strict_has_true_top(u->pass) && !u->bottom_done &&
                  u->last < frame_of(s, u->frame)->nlines;

    return !is_gone(u) && (bottom || u->pass->lend > 0);
}

/* When to look at the unit again; u->wait is up to date. */
static uint64_t
due_ms(const struct strict *s, const struct strict_unit *u, uint64_t now_ms)
{
    uint64_t due = STRICT_NEVER;

    if (u->pass)
        return is_awaited(s, u) ? now_ms + LOOK_MS : due;
    if (will_keep(s, u))
        due = u->wait.since_ms + PARK_MS;
    return due;
}

static void
tick_unit(struct strict *s, struct strict_unit *u, uint64_t now_ms)
{
    bool waiting = rank_waits(s, u);

    if (waiting && !u->wait.waiting)
        u->wait.since_ms = now_ms;
    u->wait.waiting = waiting;
    order_park(s, u);
    if (will_keep(s, u) && now_ms - u->wait.since_ms >= PARK_MS)
        park_facts(s, u);
}

uint64_t
strict_tick(struct strict *s, uint64_t now_ms)
{
    uint64_t due = STRICT_NEVER;

    for (struct strict_unit *u = s->units; u; u = u->next) {
        uint64_t at;

        tick_unit(s, u, now_ms);
        at = due_ms(s, u, now_ms);
        due = at < due ? at : due;
    }
    return due;
}
