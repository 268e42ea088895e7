/* strict_edge.c - the tops of the strict units
 *
 * They belong to a line (struct edge), and are put together from pieces, which
 * may come in any order, twice, or before the unit that needs them.  A bottom
 * that was made here is kept for a unit below that may come; since the
 * coordinator has a copy, an edge that nobody has asked for may go when there
 * are too many. */
#include "config.h"

#include "strict/strict_impl.h"

#include <stdlib.h>
#include <string.h>

/* Edges that no unit here asks for. */
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
    const struct strict_unit *u = s->by_first[slot_of(e->frame, e->line + 1)];

    while (u && (is_gone(u) || u->frame != e->frame || u->first - 1 != e->line))
        u = u->same_first;
    return u;
}

static void
edge_free(struct edge *e)
{
    if (!e)
        return;
    free(e->pixels);
    free(e->density);
    free(e->have);
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

/* Let the oldest go that nobody asks for, if there are too many. */
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
    const struct frame *f = frame_of(s, frame);
    size_t width = (size_t)f->q.width;

    if (e)
        return e;
    edges_limit(s);
    e = calloc(1, sizeof *e);
    if (e) {
        e->frame = frame;
        e->line = line;
        e->pixels = calloc(width, sizeof *e->pixels);
        e->density = calloc(f->ndensity + 1, 1);
        e->have = calloc(width + f->ndensity, 1);
        e->missing = width + f->ndensity;
    }
    if (!e || !e->pixels || !e->density || !e->have) {
        edge_free(e);
        s->error = RAD_ENOMEM;
        return NULL;
    }
    while (*at)
        at = &(*at)->next;
    *at = e;
    e->chained = s->by_line[slot_of(frame, line)];
    s->by_line[slot_of(frame, line)] = e;
    return e;
}

static void
edge_have(struct edge *e, size_t i)
{
    e->missing -= !e->have[i];
    e->have[i] = 1;
}

void
edge_pixel(struct edge *e, int x, const struct rad_pixel *p)
{
    e->pixels[x] = *p;
    edge_have(e, (size_t)x);
}

void
edge_density(struct edge *e, const struct frame *f, size_t d, uint8_t density)
{
    e->density[d] = density;
    edge_have(e, (size_t)f->q.width + d);
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
