/* host_lines.c - base lines that go straight to whoever has the lines below, as
 * worker/relay.c has them */
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

static void
send(struct host *h, struct bottom *b)
{
    struct msg m = { .type = MSG_BASE_LINE };

    m.base_line.job = h->cluster->job;
    m.base_line.frame = b->frame;
    m.base_line.line = b->line;
    while (b->to >= 0 &&
           shelf_piece(&b->shelf, &b->sent_x, &b->sent_d, &m.base_line))
        cluster_send_peer(h->cluster, h->number, b->to, &m);
}

void
host_lines_pass_on(struct host *h, const struct msg *m)
{
    struct bottom *b = bottom_of(h, m->base_line.frame, m->base_line.line);

    if (shelf_put(&b->shelf, &m->base_line) < 0)
        abort();
    send(h, b);
}

void
host_lines_next_holder(struct host *h, const struct msg_next_holder *n)
{
    struct bottom *b = bottom_of(h, n->frame, n->line);

    b->to = cluster_find(h->cluster, n->name);
    if (b->to == h->number)
        b->to = -1; /* it has it itself */
    b->sent_x = b->sent_d = 0;
    send(h, b);
}

void
host_lines_forget(struct host *h)
{
    while (h->bottoms) {
        struct bottom *b = h->bottoms;

        h->bottoms = b->next;
        shelf_clear(&b->shelf);
        free(b);
    }
}
