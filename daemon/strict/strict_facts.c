/* strict_facts.c - the facts of the strict units' lines
 *
 * Facts belong to a line, not to a unit.  They stay while a unit of this child
 * covers the line, or until they are sent.  So facts that a unit made of the
 * base line above it serve the unit that has that line, and lines that a unit
 * gave away leave their facts to the next unit. */
#include "config.h"

#include "strict/strict_facts.h"

#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

/* Most bytes of facts of lines that no unit of this child has. */
#define SPARE_FACTS (64u << 20)

/* Are facts of the line in the urgent queue?  (Units whose facts are in the
 * lazy queue are still here.) */
static bool
is_to_be_sent(const struct strict *s, uint32_t frame, int line)
{
    for (const struct item *i = s->urgent.first; i; i = i->next)
        if (i->kind == ITEM_FACTS && i->frame == frame && i->line == line)
            return true;
    return false;
}

/* Does a unit other than `by' cover the line, or are its facts to be sent? */
static bool
is_needed_but_for(const struct strict *s, uint32_t frame, int line,
                  const struct strict_unit *by)
{
    for (const struct strict_unit *u = s->units; u; u = u->next)
        if (u != by && covers(u, frame, line))
            return true;
    return is_to_be_sent(s, frame, line);
}

static bool
facts_needed(const struct strict *s, uint32_t frame, int line)
{
    return is_needed_but_for(s, frame, line, NULL);
}

struct rad_facts *
facts_at(const struct strict *s, uint32_t frame, int line)
{
    const struct frame *f = frame_of(s, frame);

    if (!f->facts)
        return NULL;
    return atomic_load_explicit(&f->facts[line], memory_order_relaxed);
}

bool
facts_make_table(struct strict *s, uint32_t frame)
{
    struct frame *f = &s->frames[frame];

    if (!f->facts)
        f->facts = calloc((size_t)f->nlines, sizeof *f->facts);
    if (!f->facts)
        s->error = RAD_ENOMEM;
    return f->facts;
}

/* The facts of a line, made empty if need be; NULL: memory is out. */
static struct rad_facts *
facts_make(struct strict *s, uint32_t frame, int line)
{
    struct frame *f = &s->frames[frame];
    struct rad_facts *facts = facts_at(s, frame, line);

    if (facts)
        return facts;
    if (facts_make_table(s, frame))
        facts = rad_facts_new(f->q.width, team_line_rows(&f->q, line));
    if (!facts) {
        s->error = RAD_ENOMEM;
        return NULL;
    }
    /* pairs with the loads of a team that looks for new facts */
    atomic_store_explicit(&f->facts[line], facts, memory_order_release);
    return facts;
}

bool
facts_make_all(struct strict *s, const struct strict_unit *u)
{
    for (int i = strict_unit_top(u); i < u->last; i++)
        if (!facts_make(s, u->frame, i))
            return false;
    return true;
}

static void
early_unlink(struct strict *s, struct early **at)
{
    struct early *e = *at;

    *at = e->next;
    if (!*at)
        s->early_end = at;
    s->early_bytes -= e->bytes;
    free(e);
}

static void
early_forget(struct strict *s, uint32_t frame, int line)
{
    struct early **at = &s->early;

    while (*at && ((*at)->frame != frame || (*at)->line != line))
        at = &(*at)->next;
    if (*at)
        early_unlink(s, at);
}

void
facts_drop(struct strict *s, uint32_t frame, int line)
{
    struct rad_facts *facts = facts_at(s, frame, line);

    if (!facts || facts_needed(s, frame, line))
        return;
    early_forget(s, frame, line);
    atomic_store_explicit(&s->frames[frame].facts[line], NULL,
                          memory_order_relaxed);
    rad_facts_free(facts);
}

/* Facts came of a line that no unit of this child has.  If there are too many
 * such facts free the oldest. */
static void
early_add(struct strict *s, uint32_t frame, int line)
{
    const struct frame *f = frame_of(s, frame);
    struct early *e = calloc(1, sizeof *e);

    if (!e) {
        s->error = RAD_ENOMEM;
        return;
    }
    e->frame = frame;
    e->line = line;
    e->bytes = (size_t)f->q.width * (size_t)team_line_rows(&f->q, line) *
               (sizeof(struct rad_pixel) + 1);
    *s->early_end = e;
    s->early_end = &e->next;
    s->early_bytes += e->bytes;
    while (s->early != e && s->early_bytes > SPARE_FACTS) {
        uint32_t old_frame = s->early->frame;
        int old_line = s->early->line;

        early_unlink(s, &s->early);
        facts_drop(s, old_frame, old_line);
    }
}

void
facts_drop_table(struct strict *s, uint32_t frame)
{
    struct frame *f = &s->frames[frame];

    for (const struct strict_unit *u = s->units; u; u = u->next)
        if (u->frame == frame)
            return; /* its pass may use the table */
    for (int i = 0; f->facts && i < f->nlines; i++)
        if (facts_at(s, frame, i))
            return;
    free((void *)f->facts);
    f->facts = NULL;
}

/* The facts of a line that are freed with the unit; NULL: it has none. */
static const struct rad_facts *
facts_of_alone(const struct strict *s, const struct strict_unit *u, int line)
{
    const struct rad_facts *facts = facts_at(s, u->frame, line);

    return facts && !is_needed_but_for(s, u->frame, line, u) ? facts : NULL;
}

/* How many facts are freed with the unit and were sent to no worker. */
static uint64_t
untold(const struct strict *s, const struct strict_unit *u, int line)
{
    const struct rad_facts *facts = facts_of_alone(s, u, line);

    return facts ? rad_facts_fresh(facts) + rad_facts_late(facts) : 0;
}

uint64_t
facts_untold(const struct strict *s, const struct strict_unit *u)
{
    uint64_t n = 0;

    for (int i = strict_unit_top(u); i < u->last; i++)
        n += untold(s, u, i);
    return n;
}

uint64_t
facts_late(const struct strict *s, const struct strict_unit *u)
{
    const struct rad_facts *facts = facts_of_alone(s, u, u->first);

    return facts ? rad_facts_late(facts) : 0;
}

uint64_t
facts_unused(const struct strict *s, const struct strict_unit *u)
{
    uint64_t n = u->above == ABOVE_MADE_HERE ? untold(s, u, u->first - 1) : 0;

    for (int i = u->first; i < u->last; i++) {
        const struct rad_facts *facts = facts_at(s, u->frame, i);

        n += facts ? rad_facts_unused(facts) : 0;
        n += facts ? rad_facts_doubled(facts) : 0;
    }
    return n;
}

static bool
facts_fit(const struct strict *s, const struct msg_facts *m)
{
    const struct frame *f;

    if (m->frame >= s->nframes)
        return false;
    f = frame_of(s, m->frame);
    return m->line < (uint32_t)f->nlines && m->width == (uint32_t)f->q.width &&
           m->channels == channels_of(f);
}

/* For sampling a line over facts alone: does any pixel lack? */
struct trial {
    const struct rad_facts *facts;
    bool lacks;
};

static void
try_fact(void *arg, int x, int y, struct rad_pixel *out)
{
    struct trial *t = arg;

    (void)y;
    if (!rad_facts_get(t->facts, x, rad_facts_rows(t->facts) - 1, out)) {
        *out = (struct rad_pixel){ .z = 0 };
        t->lacks = true;
    }
}

/* Are all facts of a base line here that the sampler wants when it guesses the
 * densities above? */
static bool
facts_suffice(struct strict *s, uint32_t frame, int line)
{
    const struct frame *f = frame_of(s, frame);
    struct trial t = { facts_at(s, frame, line), false };
    struct rad_quincunx q = f->q;
    struct rad_pixel *pixels;
    uint8_t *density;

    if (!t.facts)
        return false;
    pixels = malloc((size_t)q.width * sizeof *pixels);
    density = malloc(f->ndensity + 1);
    q.trace = try_fact;
    q.arg = &t;
    if (pixels && density) {
        rad_quincunx_guess(&q, density);
        rad_quincunx_base(&q, line, density, pixels);
    } else {
        s->error = RAD_ENOMEM;
    }
    free(pixels);
    free(density);
    return !s->error && !t.lacks;
}

void
facts_use_above(struct strict *s, struct strict_unit *u)
{
    if (u->first == 0 || u->loan || u->above != ABOVE_LEFT_OUT ||
        strict_unit_has_top(s, u) || strict_unit_above(s, u) ||
        !facts_suffice(s, u->frame, u->first - 1))
        return;
    u->above = ABOVE_KNOWN;
    if (u->progress == PROGRESS_AHEAD)
        strict_unit_advance(u, PROGRESS_LINES);
}

static void
use_above(struct strict *s, const struct msg_facts *m)
{
    const struct frame *f = frame_of(s, m->frame);
    int line = (int)m->line;

    if ((int)(m->row + m->rows) < team_line_rows(&f->q, line))
        return;
    for (struct strict_unit *u = s->units; u; u = u->next)
        if (!is_gone(u) && u->frame == m->frame && u->first - 1 == line)
            facts_use_above(s, u);
}

void
strict_facts(struct strict *s, const struct msg_facts *m)
{
    struct rad_fact_rows of = { (int)m->row, (int)m->rows, m->channels,
                                RAD_FACT_FOREIGN };
    struct rad_facts *facts;
    size_t n = (size_t)m->npixels * m->channels;
    float *pixels;

    if (!facts_fit(s, m))
        return;
    facts = facts_at(s, m->frame, (int)m->line);
    if (!facts && (facts = facts_make(s, m->frame, (int)m->line)) &&
        !facts_needed(s, m->frame, (int)m->line))
        early_add(s, m->frame, (int)m->line);
    pixels = malloc(n * sizeof *pixels + 1);
    if (facts && pixels) {
        if (m->flags & MSG_FACTS_ESTIMATE)
            of.origin |= RAD_FACT_ESTIMATE;
        wire_floats_get(pixels, m->pixels, n);
        rad_facts_import(facts, &of, m->bitmap, pixels, m->npixels);
        use_above(s, m);
    }
    free(pixels);
}

static void
release_frame(struct frame *f)
{
    for (int i = 0; f->facts && i < f->nlines; i++)
        rad_facts_free(
            atomic_load_explicit(&f->facts[i], memory_order_relaxed));
    free((void *)f->facts);
}

void
facts_release(struct strict *s)
{
    while (s->early)
        early_unlink(s, &s->early);
    for (uint32_t i = 0; i < s->nframes; i++)
        release_frame(&s->frames[i]);
}
