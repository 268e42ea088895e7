/* strict_edge.c - tops and bottoms of the strict units
 *
 * Pieces of a top that another worker makes may come twice, or before the unit
 * that needs it; they lie on a shelf until all have come.  Bottoms that this
 * child made are kept for units below that may come.  When there are too many
 * edges the oldest that no unit needs are freed, for the coordinator has a
 * copy.
 */
#include "config.h"

#include "strict/strict_edge.h"

#include "strict/strict_state.h"

#include <stdlib.h>
#include <string.h>

/* Most edges that no unit of this child needs. */
#define SPARE_EDGES 256

struct edge *
edge_find(const struct strict *s, uint32_t frame, int line)
{
    struct edge *e = s->by_line[slot_of(frame, line)];

    while (e && (e->frame != frame || e->line != line))
        e = e->chained;
    return e;
}

static bool
edge_needed(const struct strict *s, const struct edge *e)
{
    return unit_from(s, e->frame, e->line + 1) ||
           (e->guess && unit_from(s, e->frame, e->line + 2));
}

static void
edge_free(struct edge *e)
{
    if (!e)
        return;
    shelf_clear(&e->shelf);
    free(e->pixels);
    free(e->density);
    free(e->guess);
    free(e);
}

void
edge_drop(struct strict *s, uint32_t frame, int line)
{
    struct edge *e = edge_find(s, frame, line);
    struct edge **at = &s->edges, **slot = &s->by_line[slot_of(frame, line)];

    if (!e || edge_needed(s, e))
        return;
    while (*at != e)
        at = &(*at)->next;
    *at = e->next;
    while (*slot != e)
        slot = &(*slot)->chained;
    *slot = e->chained;
    edge_free(e);
}

void
edge_drop_guess(struct strict *s, uint32_t frame, int line)
{
    const struct edge *e = edge_find(s, frame, line);

    if (e && !e->pixels && e->shelf.channels == 0) /* no piece came */
        edge_drop(s, frame, line);
}

/* Free the oldest edges that no unit needs, if there are too many. */
static void
edges_limit(struct strict *s)
{
    size_t spare = 0;

    for (const struct edge *e = s->edges; e; e = e->next)
        spare += !edge_needed(s, e);
    for (struct edge *e = s->edges, *next; e && spare > SPARE_EDGES; e = next) {
        next = e->next;
        if (edge_needed(s, e))
            continue;
        spare--;
        edge_drop(s, e->frame, e->line);
    }
}

struct edge *
edge_make(struct strict *s, uint32_t frame, int line)
{
    struct edge *e = edge_find(s, frame, line), **at = &s->edges;

    if (e)
        return e;
    edges_limit(s);
    e = calloc(1, sizeof *e);
    if (!e) {
        s->error = RAD_ENOMEM;
        return NULL;
    }
    e->frame = frame;
    e->line = line;
    while (*at)
        at = &(*at)->next;
    *at = e;
    e->chained = s->by_line[slot_of(frame, line)];
    s->by_line[slot_of(frame, line)] = e;
    return e;
}

/* Make room for the values of a line; false: memory is out. */
static bool
edge_alloc(struct strict *s, struct edge *e)
{
    const struct frame *f = frame_of(s, e->frame);

    e->pixels = malloc((size_t)f->q.width * sizeof *e->pixels);
    e->density = malloc(f->ndensity + 1);
    if (e->pixels && e->density)
        return true;
    free(e->pixels);
    free(e->density);
    e->pixels = NULL;
    e->density = NULL;
    s->error = RAD_ENOMEM;
    return false;
}

bool
edge_set(struct strict *s, struct edge *e, const struct rad_pixel *pixels,
         const uint8_t *density)
{
    const struct frame *f = frame_of(s, e->frame);

    if (e->pixels)
        return true;
    if (!edge_alloc(s, e))
        return false;
    memcpy(e->pixels, pixels, (size_t)f->q.width * sizeof *e->pixels);
    if (f->ndensity > 0)
        memcpy(e->density, density, f->ndensity);
    shelf_clear(&e->shelf);
    return true;
}

void
edge_decode(struct rad_pixel *to, const uint8_t *from, uint32_t n, int channels)
{
    for (uint32_t i = 0; i < n; i++) {
        float v[4] = { 0 };

        wire_floats_get(v, from, (size_t)channels);
        from += (size_t)channels * sizeof(float);
        to[i] = (struct rad_pixel){ { v[0], v[1], v[2] }, v[3] };
    }
}

bool
edge_put(struct strict *s, struct edge *e, const struct msg_base_line *m)
{
    const struct frame *f = frame_of(s, e->frame);
    struct shelf_size size = edge_size(s, e->frame);

    if (e->pixels)
        return false;
    if (shelf_put(&e->shelf, m) != 0) {
        s->error = RAD_ENOMEM;
        return false;
    }
    if (!shelf_is_whole(&e->shelf, &size) || !edge_alloc(s, e))
        return false;
    edge_decode(e->pixels, e->shelf.pixels, (uint32_t)f->q.width,
                size.channels);
    if (f->ndensity > 0)
        memcpy(e->density, e->shelf.density, f->ndensity);
    shelf_clear(&e->shelf);
    return true;
}

void
edge_guess(struct strict *s, struct edge *e, const struct msg_guess *m)
{
    if (m->known <= e->known)
        return;
    if (!e->guess && !(e->guess = malloc(m->ndensity + 1))) {
        s->error = RAD_ENOMEM;
        return;
    }
    memcpy(e->guess, m->density, m->ndensity);
    e->known = m->known;
}

struct shelf_size
edge_size(const struct strict *s, uint32_t frame)
{
    const struct frame *f = frame_of(s, frame);

    return (struct shelf_size){ (uint32_t)f->q.width, (uint32_t)f->ndensity,
                                (uint8_t)channels_of(f) };
}

void
edge_release(struct strict *s)
{
    while (s->edges) {
        struct edge *e = s->edges;

        s->edges = e->next;
        edge_free(e);
    }
}
