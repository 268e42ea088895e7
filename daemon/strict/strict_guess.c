/* strict_guess.c - see strict_guess.h */
#include "config.h"

#include "strict/strict_guess.h"

#include "strict/strict_edge.h"
#include "strict/strict_out.h"
#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

/* A copy of a line's densities; NULL: memory is out. */
static uint8_t *
copy_densities(const struct strict *s, uint32_t frame, const uint8_t *from)
{
    size_t n = frame_of(s, frame)->ndensity;
    uint8_t *copy = malloc(n + 1);

    if (copy && n > 0)
        memcpy(copy, from, n);
    return copy;
}

/* --- at the top --- */

/* Copy a top to the pass; pixels may be NULL.  False: memory is out. */
static bool
copy_top(const struct strict *s, struct strict_pass *p,
         const struct rad_pixel *pixels, const uint8_t *density)
{
    const struct frame *f = frame_of(s, p->frame);
    size_t n = (size_t)f->q.width * sizeof *pixels;

    if (pixels) {
        struct rad_pixel *top = malloc(n);

        p->spec.top = top;
        if (!top)
            return false;
        memcpy(top, pixels, n);
    }
    if (f->ndensity > 0)
        p->spec.top_density = copy_densities(s, p->frame, density);
    return f->ndensity == 0 || p->spec.top_density;
}

/* The guess of another worker at the densities above the line of the unit's
 * top; NULL: there is none. */
static const struct edge *
sent_guess(const struct strict *s, const struct strict_unit *u)
{
    const struct edge *e = edge_find(s, u->frame, u->first - 2);

    return goes_above(u) && e && e->guess ? e : NULL;
}

bool
guess_top(struct strict *s, struct strict_pass *p)
{
    struct team_spec *spec = &p->spec;
    const struct strict_unit *u = p->of, *a = strict_unit_above(s, u);
    const struct edge *e = edge_find(s, u->frame, spec->first - 1);
    const struct edge *sent = sent_guess(s, u);

    if (u->loan)
        return true;
    spec->ahead.top_known =
        spec->first > 0 && frame_of(s, u->frame)->ndensity > 0 ? 0 : TEAM_SURE;
    /* true densities might let the pass trace pixels of the line above that the
     * worker of that line traces, too; a guess that this worker sent came after
     * facts of these pixels */
    if (spec->first < u->first && u->above != ABOVE_MADE_HERE)
        e = NULL;
    /* if spec->first is another unit's line only its base line is made, no bar */
    if (e && e->pixels) {
        spec->ahead.top_known = TEAM_SURE;
        return copy_top(s, p, spec->first == u->first ? e->pixels : NULL,
                        e->density);
    }
    if (spec->first < u->first && sent) {
        spec->ahead.top_known = sent->known;
        return copy_top(s, p, NULL, sent->guess);
    }
    if (spec->first == u->first && a && a->guess.pixels) {
        spec->ahead.top_known = a->guess.known;
        return copy_top(s, p, a->guess.pixels, a->guess.density);
    }
    return true;
}

/* How many lines the best guess at the densities above the unit's first line
 * follows from. */
static int
known_above(const struct strict *s, const struct strict_unit *u)
{
    const struct strict_unit *a = strict_unit_above(s, u);
    const struct edge *sent = sent_guess(s, u);

    if (goes_above(u))
        return 1 + (sent ? sent->known : 0);
    return a && a->guess.pixels ? a->guess.known : 0;
}

bool
guess_is_better(const struct strict *s, const struct strict_unit *u)
{
    return u->top_known < TEAM_SURE && known_above(s, u) > u->top_known;
}

static bool
guess_fits(const struct strict *s, const struct msg_guess *m)
{
    return is_above_a_line(s, m->frame, m->line) &&
           m->ndensity == frame_of(s, m->frame)->ndensity;
}

/* Let a pass that traces ahead on less than is known now stop: LINES, which
 * other workers wait for, comes first. */
static void
make_way(struct strict *s, uint32_t frame, int first)
{
    struct strict_unit *u = s->by_first[slot_of(frame, first)];

    for (; u; u = u->same_first)
        if (u->frame == frame && u->first == first && u->pass &&
            u->pass->rank == STRICT_AHEAD && guess_is_better(s, u))
            u->pass->stop = true;
}

void
strict_guess(struct strict *s, const struct msg_guess *m)
{
    struct edge *e;

    if (!guess_fits(s, m) || !(e = edge_make(s, m->frame, (int)m->line)))
        return;
    edge_guess(s, e, m);
    make_way(s, m->frame, (int)m->line + 2);
}

/* --- at the bottom --- */

/* The densities after a line as the unit's passes made them; NULL: they did
 * not. */
static const uint8_t *
recorded(const struct strict *s, const struct strict_unit *u, int line)
{
    const struct strict_chain *c = &u->chain;

    return c->density && line >= c->first && line < c->last
               ? c->density + (size_t)(line - c->first) *
                                  frame_of(s, u->frame)->ndensity
               : NULL;
}

bool
guess_record(const struct strict *s, struct strict_pass *p)
{
    struct team_spec *spec = &p->spec;
    size_t n = frame_of(s, p->frame)->ndensity;

    if (n == 0 || spec->mode == TEAM_TRUTH || spec->mode == TEAM_LOAN)
        return true;
    spec->ahead.record = malloc((size_t)(spec->last - spec->first) * n);
    return spec->ahead.record;
}

/* Keep the densities that a pass recorded, unless more lines are kept already;
 * false: they are not kept. */
static bool
keep_record(struct strict_unit *u, struct strict_pass *p)
{
    struct team_spec *spec = &p->spec;

    if (!spec->ahead.record || p->finished <= spec->first ||
        p->finished < u->chain.last)
        return false;
    free(u->chain.density);
    u->chain = (struct strict_chain){ .density = spec->ahead.record,
                                      .first = spec->first,
                                      .last = p->finished,
                                      .known = spec->ahead.top_known };
    spec->ahead.record = NULL;
    return true;
}

/* Set the guess at the bottom, and at the densities above the unit if these are
 * not NULL. */
static void
set_guess(struct strict *s, struct strict_unit *u, const struct team_bottom *b,
          const uint8_t *above)
{
    const struct frame *f = frame_of(s, u->frame);
    size_t n = (size_t)f->q.width * sizeof *u->guess.pixels;

    if (!u->guess.pixels) {
        u->guess.pixels = malloc(n);
        u->guess.density = malloc(f->ndensity + 1);
    }
    if (!u->guess.pixels || !u->guess.density) {
        s->error = RAD_ENOMEM;
        return;
    }
    memcpy(u->guess.pixels, b->pixels, n);
    if (f->ndensity > 0)
        memcpy(u->guess.density, b->density, f->ndensity);
    free(u->guess.above);
    u->guess.above = NULL;
    if (above || f->ndensity == 0) /* there may be no densities */
        u->guess.above = copy_densities(s, u->frame, above);
}

void
guess_keep(struct strict *s, struct strict_pass *p, bool done,
           const struct team_bottom *b)
{
    const struct team_spec *spec = &p->spec;
    struct strict_unit *u = p->of;
    bool kept = keep_record(u, p);
    const uint8_t *above = spec->top_density;

    if (!done || spec->mode == TEAM_TRUTH || spec->mode == TEAM_LOAN)
        return;
    if (spec->first < u->first)
        above = kept ? recorded(s, u, u->first - 1) : NULL;
    u->guess.known = spec->ahead.top_known + spec->last - spec->first;
    u->top_known = spec->ahead.top_known + u->first - spec->first;
    if (b->pixels)
        set_guess(s, u, b, above);
}

/* The densities above the unit's last line, and how many lines they follow
 * from; NULL: they are not known. */
static const uint8_t *
above_last(const struct strict *s, const struct strict_unit *u, int *known)
{
    int line = u->last - 2;
    const uint8_t *density = recorded(s, u, line);

    *known =
        density ? u->chain.known + line + 1 - u->chain.first : u->top_known;
    if (!density && u->last - u->first == 1)
        density = u->guess.above;
    if (*known > TEAM_SURE)
        *known = TEAM_SURE;
    return density;
}

void
guess_send(struct strict *s, struct strict_unit *u)
{
    int known;
    const uint8_t *density = above_last(s, u, &known);

    /* if the last line was not made from them the worker below would trace
     * pixels of it that this one traces, too */
    if (!density || known <= u->guess.told || u->chain.last < u->last)
        return;
    u->guess.told = known;
    out_guess(s, u, u->last - 2, known, density);
}

bool
guess_holds(const struct strict *s, const struct strict_unit *u,
            const uint8_t *density)
{
    const struct frame *f = frame_of(s, u->frame);

    return u->guess.pixels && u->guess.above && !s->painted &&
           !u->bottom_done && u->last < f->nlines &&
           memcmp(u->guess.above, density, f->ndensity) == 0;
}
