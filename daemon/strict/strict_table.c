/* strict_table.c - the strict units of a child, found by number and by line */
#include "config.h"

#include "strict/strict_impl.h"

#include <stdlib.h>

struct strict_unit *
unit_find(const struct strict *s, uint32_t unit, uint32_t attempt)
{
    struct strict_unit *u = s->units;

    while (u && (u->unit != unit || u->attempt != attempt || u->gone))
        u = u->next;
    return u;
}

/* Units whose first line, or the one after the last, may be that line. */
static struct strict_unit **
first_slot(struct strict *s, uint32_t frame, int line)
{
    return &s->by_first[slot_of(frame, line)];
}

static struct strict_unit **
last_slot(struct strict *s, uint32_t frame, int line)
{
    return &s->by_last[slot_of(frame, line)];
}

void
unit_link_first(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = first_slot(s, u->frame, u->first);

    while (*at)
        at = &(*at)->same_first;
    *at = u;
}

void
unit_link_last(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = last_slot(s, u->frame, u->last);

    while (*at)
        at = &(*at)->same_last;
    *at = u;
}

void
unit_unlink_first(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = first_slot(s, u->frame, u->first);

    while (*at != u)
        at = &(*at)->same_first;
    *at = u->same_first;
    u->same_first = NULL;
}

void
unit_unlink_last(struct strict *s, struct strict_unit *u)
{
    struct strict_unit **at = last_slot(s, u->frame, u->last);

    while (*at != u)
        at = &(*at)->same_last;
    *at = u->same_last;
    u->same_last = NULL;
}

void
unit_free_guess(struct strict_unit *u)
{
    free(u->guess);
    free(u->guess_density);
    free(u->guess_above);
    u->guess = NULL;
    u->guess_density = u->guess_above = NULL;
}

void
unit_free_loan(struct loan *l)
{
    if (!l)
        return;
    free(l->pixels);
    free(l->bytes);
    free(l);
}

void
unit_free(struct strict_unit *u)
{
    if (!u)
        return;
    unit_free_guess(u);
    free(u->chain);
    free(u->cpu_ns);
    unit_free_loan(u->loan);
    free(u);
}

bool
unit_count_lines(struct strict_unit *u)
{
    u->nlines = u->last - u->first + 1;
    u->cpu_ns = calloc((size_t)u->nlines, sizeof *u->cpu_ns);
    return u->cpu_ns;
}

bool
unit_has_top(const struct strict *s, const struct strict_unit *u)
{
    const struct edge *e;

    if (u->first == 0)
        return true;
    e = edge_find(s, u->frame, u->first - 1);
    return e && e->missing == 0;
}

/* The unit here whose bottom is this one's top; NULL: none. */
struct strict_unit *
unit_above(const struct strict *s, const struct strict_unit *u)
{
    struct strict_unit *a = s->by_last[slot_of(u->frame, u->first)];

    while (a && (a->gone || a->frame != u->frame || a->last != u->first))
        a = a->same_last;
    return a;
}

struct strict_unit *
unit_below(const struct strict *s, const struct strict_unit *u)
{
    struct strict_unit *b = s->by_first[slot_of(u->frame, u->last)];

    while (b && (b->gone || b->frame != u->frame || b->first != u->last))
        b = b->same_first;
    return b;
}

static uint64_t
most(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* Each pass goes over the same lines again. */
void
unit_made(struct strict_unit *u, const struct team_made *made)
{
    u->made.base = most(u->made.base, made->base);
    u->made.bars = most(u->made.bars, made->bars);
}
