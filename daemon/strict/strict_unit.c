/* strict_unit.c - see strict_unit.h */
#include "config.h"

#include "strict/strict_unit.h"

#include "strict/strict_edge.h"
#include "strict/strict_state.h"

#include <stdlib.h>

const struct steps strict_progress_steps = {
    STRICT_PROGRESSES,
    {
        [PROGRESS_NONE] = { "none", STEP(PROGRESS_LINES) },
        [PROGRESS_LINES] = { "lines", STEP(PROGRESS_AHEAD) },
        [PROGRESS_AHEAD] = { "ahead", STEP(PROGRESS_LINES) },
    },
};

const struct steps strict_fate_steps = {
    STRICT_FATES,
    {
        [FATE_STAYS] = { "stays", STEP(FATE_SPLITS) | STEP(FATE_YIELDS) |
                                      STEP(FATE_OVER) | STEP(FATE_GONE) },
        [FATE_SPLITS] = { "splits", STEP(FATE_STAYS) | STEP(FATE_YIELDS) |
                                        STEP(FATE_OVER) | STEP(FATE_GONE) },
        [FATE_YIELDS] = { "yields", STEP(FATE_OVER) | STEP(FATE_GONE) },
        [FATE_OVER] = { "over", 0 },
        [FATE_GONE] = { "gone", 0 },
    },
};

void
strict_unit_advance(struct strict_unit *u, enum strict_progress to)
{
    u->progress = (enum strict_progress)steps_take(&strict_progress_steps,
                                                   u->progress, to);
}

void
strict_unit_decide(struct strict_unit *u, enum strict_fate to)
{
    u->fate = (enum strict_fate)steps_take(&strict_fate_steps, u->fate, to);
}

int
strict_unit_top(const struct strict_unit *u)
{
    return u->first - (u->above == ABOVE_MADE_HERE);
}

struct strict_unit *
strict_unit_find(const struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = s->units;

    while (u && (u->unit != unit || u->attempt != attempt || is_gone(u)))
        u = u->next;
    return u;
}

/* Where u, or the end of the list, is in the slot of its first line; or, for
 * in_last_slot(), of the line after its last. */
static struct strict_unit **
in_first_slot(struct strict *s, const struct strict_unit *u)
{
    struct strict_unit **at = &s->by_first[slot_of(u->frame, u->first)];

    while (*at && *at != u)
        at = &(*at)->same_first;
    return at;
}

static struct strict_unit **
in_last_slot(struct strict *s, const struct strict_unit *u)
{
    struct strict_unit **at = &s->by_last[slot_of(u->frame, u->last)];

    while (*at && *at != u)
        at = &(*at)->same_last;
    return at;
}

static void
unlink_last(struct strict *s, struct strict_unit *u)
{
    *in_last_slot(s, u) = u->same_last;
    u->same_last = NULL;
}

void
strict_unit_enter(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = &s->units;

    while (*at)
        at = &(*at)->next;
    *at = u;
    if (u->loan)
        return;
    *in_first_slot(s, u) = u;
    *in_last_slot(s, u) = u;
}

void
strict_unit_leave(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = &s->units;

    while (*at != u)
        at = &(*at)->next;
    *at = u->next;
    *in_first_slot(s, u) = u->same_first; /* a loan is in no slot: no change */
    u->same_first = NULL;
    unlink_last(s, u);
}

/* Forget the guess at the unit's bottom. */
static void
free_guess(struct strict_unit *u)
{
    free(u->guess.pixels);
    free(u->guess.density);
    free(u->guess.above);
    u->guess.pixels = NULL;
    u->guess.density = u->guess.above = NULL;
    u->guess.told = 0;
}

void
strict_unit_end_at(struct strict *s, struct strict_unit *u, int last)
{
    unlink_last(s, u);
    u->last = last;
    *in_last_slot(s, u) = u;
    if (u->chain.last > last)
        u->chain.last = last;
    u->bottom_done = false;
    u->sent_columns = 0;
    u->sent_densities = 0;
    free_guess(u);
}

static void
free_loan(struct loan *l)
{
    if (!l)
        return;
    free(l->pixels);
    free(l->bytes);
    free(l);
}

void
strict_unit_free(struct strict_unit *u)
{
    if (!u)
        return;
    free_guess(u);
    free(u->chain.density);
    free(u->cpu_ns);
    free_loan(u->loan);
    free(u);
}

struct strict_unit *
strict_unit_new(uint32_t unit, uint32_t attempt, uint32_t frame, int first,
                int last)
{
    struct strict_unit *u = calloc(1, sizeof *u);

    if (!u)
        return NULL;
    *u = (struct strict_unit){ .unit = unit,
                               .attempt = attempt,
                               .frame = frame,
                               .first = first,
                               .last = last,
                               .nlines = last - first + 1 };
    u->cpu_ns = calloc((size_t)u->nlines, sizeof *u->cpu_ns);
    if (!u->cpu_ns) {
        strict_unit_free(u);
        return NULL;
    }
    return u;
}

bool
strict_unit_has_top(const struct strict *s, const struct strict_unit *u)
{
    const struct edge *e;

    if (u->first == 0)
        return true;
    e = edge_find(s, u->frame, u->first - 1);
    return e && e->pixels;
}

struct strict_unit *
strict_unit_above(const struct strict *s, const struct strict_unit *u)
{
    struct strict_unit *a = s->by_last[slot_of(u->frame, u->first)];

    while (a && (is_gone(a) || a->frame != u->frame || a->last != u->first))
        a = a->same_last;
    return a;
}

struct strict_unit *
strict_unit_below(const struct strict *s, const struct strict_unit *u)
{
    return unit_from(s, u->frame, u->last);
}

static uint64_t
most(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* The most of each, for each pass goes over the same lines again. */
void
strict_unit_made(struct strict_unit *u, const struct team_made *made)
{
    u->made.base = most(u->made.base, made->base);
    u->made.bars = most(u->made.bars, made->bars);
}
