/* host_lines.c - base lines that go straight to whoever has the lines below */
#include "config.h"

#include "host_impl.h"

#include <stdlib.h>

static struct bottom *
bottom_of(struct host *h, uint32_t frame, uint32_t line)
{
    struct bottom *b = h->bottoms;

    while (b && (b->frame != frame || b->line != line))
        b = b->next;
    if (!b) {
        b = sim_alloc(sizeof *b);
        b->frame = frame;
        b->line = line;
        b->to = -1;
        b->next = h->bottoms;
        h->bottoms = b;
    }
    return b;
}

void
host_lines_pass_on(struct host *h, const struct msg *m)
{
    const struct msg_base_line *l = &m->base_line;
    struct bottom *b = bottom_of(h, l->frame, l->line);

    b->made |= l->x + l->n == (uint32_t)host_map(h)->q.width;
    if (b->to >= 0)
        cluster_send_peer(h->cluster, h->number, b->to, m);
}

void
host_lines_next_holder(struct host *h, const struct msg_next_holder *n)
{
    struct bottom *b = bottom_of(h, n->frame, n->line);
    const struct map *map = host_map(h);
    struct msg m = { .type = MSG_BASE_LINE };

    b->to = cluster_find(h->cluster, n->name);
    if (b->to == h->number)
        b->to = -1; /* it has it itself */
    if (b->to < 0 || !b->made)
        return;
    m.base_line =
        (struct msg_base_line){ .job = h->cluster->job,
                                .frame = n->frame,
                                .line = n->line,
                                .n = (uint32_t)map->q.width,
                                .ndensity =
                                    (uint32_t)rad_quincunx_ndensity(&map->q),
                                .channels = 3,
                                .density = h->density,
                                .pixels = h->bytes };
    cluster_send_peer(h->cluster, h->number, b->to, &m);
}

void
host_lines_forget(struct host *h)
{
    while (h->bottoms) {
        struct bottom *b = h->bottoms;

        h->bottoms = b->next;
        free(b);
    }
}
