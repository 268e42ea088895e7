/* strict_pass.c - the passes of strict units: how they begin and end
 *
 * A pass begins with the colours and densities that are known of its unit's
 * top, and ends with a bottom that is a guess or true.  A pass on a guess is
 * told to stop when the true top comes.  strict_rank.c decides which unit gets
 * the next pass. */
#include "config.h"

#include "strict/strict.h"

#include "strict/strict_edge.h"
#include "strict/strict_facts.h"
#include "strict/strict_guess.h"
#include "strict/strict_loan.h"
#include "strict/strict_order.h"
#include "strict/strict_out.h"
#include "strict/strict_rank.h"
#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

/* Most pixels of a unit whose facts are kept in case lines of it are given
 * away. */
#define MOST_KEPT (1 << 22)

/* Make the guessed bottom of the unit true; returns its edge, NULL: memory is
 * out. */
static const struct edge *
make_guess_true(struct strict *s, struct strict_unit *u)
{
    struct edge *e = edge_make(s, u->frame, u->last - 1);

    if (!e || !edge_set(s, e, u->guess.pixels, u->guess.density))
        return NULL;
    u->bottom_done = true;
    out_bottom(s, u, u->guess.pixels, u->guess.density);
    return e;
}

/* The edge is whole: the true top of units below it.  If that makes the bottom
 * of such a unit true, returns the edge of that bottom; else NULL. */
static const struct edge *
top_of_below(struct strict *s, const struct edge *e, bool *idle)
{
    struct strict_unit *u = s->by_first[slot_of(e->frame, e->line + 1)];
    const struct edge *next = NULL;

    for (; u; u = u->same_first) {
        if (is_gone(u) || u->frame != e->frame || u->first - 1 != e->line)
            continue;
        out_forget(s, u);
        if (!u->pass)
            *idle = true;
        else if (!strict_has_true_top(u->pass))
            u->pass->stop = true;
        if (guess_holds(s, u, e->density))
            next = make_guess_true(s, u);
    }
    return next;
}

static void
spread_top(struct strict *s, const struct edge *e)
{
    bool idle = false;

    while (e)
        e = top_of_below(s, e, &idle);
    if (idle)
        rank_make_way(s);
}

static void
pass_free(struct strict_pass *p)
{
    if (!p)
        return;
    free((void *)p->spec.top);
    free((void *)p->spec.top_density);
    free(p->spec.ahead.record);
    free(p);
}

static enum team_mode
mode_of(enum strict_rank rank)
{
    return rank == STRICT_TRUTH   ? TEAM_TRUTH
           : rank == STRICT_LOAN  ? TEAM_LOAN
           : rank == STRICT_AHEAD ? TEAM_AHEAD
                                  : TEAM_LINES;
}

/* May another worker get the unit, or lines of it, before its end?  Then facts
 * that TRUTH traces are of use.  Not if the unit is a whole frame or very
 * large: such units hardly ever go to another worker. */
static bool
may_get_help(const struct strict *s, const struct strict_unit *u)
{
    const struct frame *f = frame_of(s, u->frame);
    int64_t rows = row_of(f, u->last) - row_of(f, u->first);

    return rows < f->q.height && rows * f->q.width <= MOST_KEPT;
}

/* Are there facts of each of the unit's lines? */
static bool
has_facts(const struct strict *s, const struct strict_unit *u)
{
    for (int i = u->first; i < u->last; i++)
        if (!facts_at(s, u->frame, i))
            return false;
    return true;
}

static struct strict_pass *
pass_new(struct strict *s, struct strict_unit *u, enum strict_rank rank)
{
    struct strict_pass *p = calloc(1, sizeof *p);
    bool facts = rank != STRICT_TRUTH || may_get_help(s, u);

    if (!p)
        return NULL;
    p->of = u;
    p->unit = u->unit;
    p->attempt = u->attempt;
    p->frame = u->frame;
    p->rank = rank;
    p->least = u->first + 1;
    p->sent_columns = u->sent_columns;
    p->sent_densities = u->sent_densities;
    p->spec = (struct team_spec){
        .mode = mode_of(rank),
        .first =
            strict_has_true_top(p) || !goes_above(u) ? u->first : u->first - 1,
        .last = u->last,
        .lent = u->lending.lent,
        .loan = u->loan ? &u->loan->is : NULL,
        .truth.out = u->out,
        .ahead.true_top = strict_has_true_top(p),
    };
    if (!facts_make_table(s, u->frame) || (facts && !facts_make_all(s, u)) ||
        !guess_top(s, p) || !guess_record(s, p)) {
        pass_free(p);
        return NULL;
    }
    p->spec.facts = frame_of(s, u->frame)->facts;
    p->spec.cpu_ns = u->cpu_ns + (p->spec.first - (u->first - 1));
    p->keeps = has_facts(s, u);
    p->lend = p->keeps ? u->lending.part : 0;
    return p;
}

struct strict_pass *
strict_next(struct strict *s, enum strict_rank least)
{
    enum strict_rank rank = STRICT_AHEAD;
    struct strict_unit *u = s->error ? NULL : rank_choose(s, &rank);
    struct strict_pass *p;

    if (!u || rank > least)
        return NULL;
    p = pass_new(s, u, rank);
    if (!p)
        s->error = RAD_ENOMEM;
    u->pass = p;
    order_resume(s, u);
    return p;
}

static bool
base_line_fits(const struct strict *s, const struct msg_base_line *m)
{
    struct shelf_size size;

    if (!is_above_a_line(s, m->frame, m->line))
        return false;
    size = edge_size(s, m->frame);
    return shelf_fits(&size, m);
}

void
strict_base_line(struct strict *s, const struct msg_base_line *m)
{
    struct edge *e;

    if (!base_line_fits(s, m))
        return;
    e = edge_make(s, m->frame, (int)m->line);
    if (e && edge_put(s, e, m))
        spread_top(s, e);
}

void
strict_bottom(struct strict *s, struct strict_pass *p,
              const struct team_bottom *b)
{
    const struct frame *f = frame_of(s, p->frame);
    bool all = b->columns == f->q.width && b->ndensity == f->ndensity;
    struct edge *e;

    if (!strict_has_true_top(p) || is_gone(p->of) || p->of->bottom_done ||
        p->spec.last == f->nlines || b->columns < p->sent_columns ||
        b->ndensity < p->sent_densities ||
        (b->columns - p->sent_columns < f->q.xstep && !all) ||
        (p->sent_columns == f->q.width && p->sent_densities == f->ndensity) ||
        !(e = edge_make(s, p->frame, p->spec.last - 1)))
        return;
    out_piece(s, p, b);
    p->sent_columns = p->of->sent_columns = b->columns;
    p->sent_densities = p->of->sent_densities = b->ndensity;
    if (!all)
        return;
    p->of->bottom_done = true;
    if (edge_set(s, e, b->pixels, b->density))
        spread_top(s, e);
}

static void
end_ahead(struct strict *s, struct strict_unit *u, struct strict_pass *p,
          const struct team_bottom *b)
{
    const struct frame *f = frame_of(s, u->frame);

    strict_bottom(s, p, b);
    if (p->spec.mode == TEAM_AHEAD)
        strict_unit_advance(u, PROGRESS_AHEAD);
    else if (u->progress < PROGRESS_LINES ||
             (u->progress > PROGRESS_LINES && !strict_has_true_top(p)))
        strict_unit_advance(u, PROGRESS_LINES);
    if (p->spec.mode == TEAM_LINES && !strict_has_true_top(p) &&
        u->last < f->nlines && !strict_unit_below(s, u)) {
        out_base_facts(s, u, u->last - 1);
        guess_send(s, u);
    }
}

/* TRUTH is done, and so the unit: sum its cost. */
static void
end_truth(struct strict *s, struct strict_pass *p, const struct team_bottom *b,
          struct msg_counts *total)
{
    const struct strict_unit *u = p->of;

    strict_bottom(s, p, b);
    strict_unit_decide(p->of, FATE_OVER);
    out_line_costs(s, u);
    *total = u->spent;
    total->speculative_rays = facts_unused(s, u);
    /* a unit below that made this bottom as its top may have facts of it */
    for (int i = u->first; i < u->last; i++)
        if (facts_at(s, u->frame, i))
            rad_facts_settle(facts_at(s, u->frame, i));
}

/* Drop the unit; if it is done its top, too, and the guess above that.  A unit
 * that was revoked may come again, and its top may have come again already. */
static void
end_unit(struct strict *s, struct strict_unit *u, bool over)
{
    uint32_t frame = u->frame;
    int top = u->first - 1;

    order_drop(s, u);
    if (!over)
        return;
    edge_drop(s, frame, top);
    edge_drop_guess(s, frame, top - 1);
}

/* Let the team lend the columns that LEND asks for, if it can. */
static void
lend_columns(struct strict *s, struct strict_pass *p, struct team *t)
{
    size_t width = (size_t)frame_of(s, p->frame)->q.width;
    struct team_loan loan = { .wanted = malloc((width + 7) / 8) };

    if (loan.wanted && team_lend(t, p->lend, &loan))
        strict_lent(s, p, &loan);
    free(loan.wanted);
}

int
strict_least(const struct strict_pass *p)
{
    return p->least > p->spec.truth.out ? p->least : p->spec.truth.out + 1;
}

void
strict_look(struct strict *s, struct strict_pass *p, struct team *t)
{
    struct team_bottom b;

    if (p->stop)
        team_stop(t);
    if (p->split)
        strict_shrunk(s, p, team_shrink(t, strict_least(p)));
    if (p->back)
        team_back(t, p->back);
    p->back = 0;
    if (p->lend > 0)
        lend_columns(s, p, t);
    if (!strict_has_true_top(p))
        return;
    team_bottom(t, &b);
    if (b.pixels)
        strict_bottom(s, p, &b);
}

void
strict_cut(struct strict *s, struct strict_pass *p, struct team *t)
{
    struct strict_unit *u = p->of;
    int last;

    if (u->fate != FATE_YIELDS || team_done(t) || (last = team_cut(t)) < 0)
        return;
    loan_forget(u);
    p->spec.last = last;
    order_give_lines(s, u, last);
    p->sent_columns = p->sent_densities = 0;
}

/* A pass of TRUTH ended early: the rows that it handed on stay valid.  The pass
 * that goes on counts all primary rays. */
static void
keep_out(struct strict_unit *u, const struct strict_pass *p)
{
    if (p->spec.mode != TEAM_TRUTH)
        return;
    u->spent.primary_rays = 0;
    if (p->stop && p->finished > u->out)
        u->out = p->finished;
}

bool
strict_ended(struct strict *s, struct strict_pass *p, bool done,
             const struct team_bottom *b, const struct msg_counts *spent,
             struct msg_counts *total)
{
    struct strict_unit *u = p->of;
    bool over = done && !is_gone(u) && p->spec.mode == TEAM_TRUTH;
    bool paid = done && p->spec.mode == TEAM_LOAN;

    msg_counts_add(&u->spent, spent);
    if (!done)
        keep_out(u, p);
    strict_unit_made(u, &p->made);
    guess_keep(s, p, done && !p->stop, b);
    if (over)
        end_truth(s, p, b, total);
    else if (paid && !is_gone(u))
        loan_end(s, u);
    else if (done && !p->stop)
        end_ahead(s, u, p, b);
    u->pass = NULL;
    pass_free(p);
    if (!is_gone(u))
        order_say_top(s, u);
    if (paid)
        order_drop(s, u);
    else if (over || is_gone(u))
        end_unit(s, u, over);
    else if (u->fate == FATE_YIELDS)
        order_hand_back(s, u);
    else if (u->fate == FATE_SPLITS)
        order_split_idle(s, u);
    for (u = s->units; u; u = u->next)
        order_park(s, u);
    return over;
}
