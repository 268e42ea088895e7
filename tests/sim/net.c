/* net.c - see net.h */
#include "config.h"

#include "net.h"

#include "base/rng.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void
net_fail(const struct net *net, const char *file, int line, const char *what)
{
    fprintf(stderr,
            "%s:%d: seed %llu at %llu ms: %s\n"
            "replay with RADD_SIM_SEED=%llu\n",
            file, line, (unsigned long long)net->seed,
            (unsigned long long)net->now_ms, what,
            (unsigned long long)net->seed);
    if (net->describe)
        net->describe(net);
    exit(EXIT_FAILURE);
}

/* The highest version that a node speaks: every fifth node is newer than our
 * program. */
static unsigned
offers(uint64_t seed, unsigned node)
{
    return rad_mix64(rad_mix64(seed) + node) % 5 == 0 ? MSG_VERSION + 7
                                                      : MSG_VERSION;
}

void
net_init(struct net *net, uint64_t seed)
{
    memset(net, 0, sizeof *net);
    net->seed = seed;
    net->random = rad_mix64(seed + 1);
    net->now_ms = 1000;
    for (unsigned i = 0; i < sizeof net->offers / sizeof net->offers[0]; i++)
        net->offers[i] = offers(seed, i);
}

static void
free_link(struct net_link *l)
{
    frame_reader_release(&l->end[0].reader);
    frame_reader_release(&l->end[1].reader);
    free(l);
}

void
net_release(struct net *net)
{
    events_release(&net->events);
    for (size_t i = 0; i < net->nlinks; i++)
        free_link(net->links[i]);
    free(net->links);
    msg_release(&net->msg);
}

unsigned
net_random(struct net *net, unsigned n)
{
    net->random = rad_mix64(net->random + UINT64_C(0x9e3779b97f4a7c15));
    return (unsigned)((net->random >> 32) * n >> 32);
}

bool
net_chance(struct net *net, unsigned n)
{
    return net_random(net, n) == 0;
}

void
net_bytes(void *arg, void *buf, size_t n)
{
    uint8_t *p = buf;

    while (n-- > 0)
        *p++ = (uint8_t)net_random(arg, 256);
}

struct event *
net_later(struct net *net, unsigned delay_ms,
          void (*fn)(void *net, struct event *e))
{
    struct event e = { .at = net->now_ms + delay_ms, .fn = fn };

    return events_add(&net->events, &e);
}

bool
net_step(struct net *net)
{
    return events_step(&net->events, &net->now_ms, net);
}

/* --- links --- */

static struct net_end
new_end(struct net *net, int node, uint64_t conn, enum msg_session session)
{
    struct net_end e = { .node = node, .conn = conn, .open = true };

    if (conn == 0)
        e.conn = ++net->next_conn;
    frame_reader_init(&e.reader, session);
    return e;
}

struct net_link *
net_join(struct net *net, int a, uint64_t a_conn, int b, uint64_t b_conn,
         enum msg_session a_session, enum msg_session b_session)
{
    struct net_link *l = calloc(1, sizeof *l);

    SIM_CHECK(net, l != NULL);
    l->end[0] = new_end(net, a, a_conn, a_session);
    l->end[1] = new_end(net, b, b_conn, b_session);
    if (net->nlinks == net->cap_links) {
        net->cap_links = net->cap_links ? 2 * net->cap_links : 64;
        net->links =
            realloc(net->links, net->cap_links * sizeof(struct net_link *));
        SIM_CHECK(net, net->links != NULL);
    }
    net->links[net->nlinks++] = l;
    return l;
}

static struct net_end *
find(struct net *net, int node, uint64_t conn, int *link, int *side)
{
    for (int i = (int)net->nlinks; i-- > 0;)
        for (int s = 0; s < 2; s++) {
            struct net_end *e = &net->links[i]->end[s];

            if (e->open && e->node == node && e->conn == conn) {
                *link = i;
                *side = s;
                return e;
            }
        }
    return NULL;
}

struct net_end *
net_find(struct net *net, int node, uint64_t conn)
{
    int link, side;

    return find(net, node, conn, &link, &side);
}

/* Send a message once more: from node e->node and connection e->n, over link
 * e->k.  The link is checked, for a later life of the node reuses connection
 * numbers. */
static void
repeat(void *net, struct event *e)
{
    int link, side;

    if (find(net, e->node, e->n, &link, &side) && link == e->k)
        net_send(net, e->node, e->n, e->bytes, e->len);
}

/* Send a message twice, at random.  The protocol lets facts, base lines and
 * tiles come twice. */
static void
maybe_repeat(struct net *net, const struct net_end *from, const struct msg *m)
{
    struct event *e;
    struct wire_out out;
    int link, side;

    if (!net->repeats || !from->open ||
        (m->type != MSG_FACTS && m->type != MSG_BASE_LINE &&
         m->type != MSG_GUESS && m->type != MSG_TILE_MADE) ||
        !net_chance(net, 20))
        return;
    net->repeated++;
    wire_out_init(&out, MSG_FRAME_MAX);
    SIM_CHECK(net, msg_pack(&out, m) == 0);
    e = net_later(net, net_random(net, 300), repeat);
    find(net, from->node, from->conn, &link, &side);
    e->node = from->node;
    e->k = link;
    e->n = from->conn;
    event_take(e, out.buf, out.len);
    wire_out_release(&out);
}

static void
tell(const struct net *net, const struct net_end *end, const struct msg *m)
{
    printf("%8llu node %d conn %llx: %s", (unsigned long long)net->now_ms,
           end->node, (unsigned long long)end->conn, msg_name(m->type));
    if (m->type == MSG_BASE_LINE)
        printf(" job %02x line %u.%u x %u n %u first %u n %u",
               m->base_line.job[0], m->base_line.frame, m->base_line.line,
               m->base_line.x, m->base_line.n, m->base_line.first,
               m->base_line.ndensity);
    else if (m->type == MSG_FACTS)
        printf(" job %02x line %u.%u pixels %u", m->facts.job[0],
               m->facts.frame, m->facts.line, m->facts.npixels);
    else if (m->type == MSG_UNIT)
        printf(" job %02x unit %u attempt %u frame %u rows %u to %u flags %u",
               m->unit.job[0], m->unit.unit, m->unit.attempt, m->unit.frame,
               m->unit.y, m->unit.y + m->unit.height, m->unit.flags);
    else if (m->type == MSG_RESULT)
        printf(" job %02x unit %u attempt %u row %u n %u", m->result.job[0],
               m->result.unit, m->result.attempt, m->result.row,
               m->result.rows);
    else if (m->type == MSG_PARKED || m->type == MSG_REVOKE ||
             m->type == MSG_SPLIT || m->type == MSG_LEND ||
             m->type == MSG_LOAN || m->type == MSG_BACK || m->type == MSG_PAID)
        printf(" job %02x unit %u attempt %u", m->parked.job[0], m->parked.unit,
               m->parked.attempt);
    printf("\n");
}

/* A whole message has arrived. */
static void
hear(struct net *net, const struct net_link *l, int side)
{
    const struct net_end *end = &l->end[side], *from = &l->end[!side];

    if (net->verbose)
        tell(net, end, &net->msg);
    if (net->hear)
        net->hear(net, from->node, end->node, &net->msg, false);
    if (!end->open || end->deaf)
        return;
    maybe_repeat(net, from, &net->msg);
    net->ops[end->node]->message(net, end->node, end->conn, &net->msg);
    if (net->hear)
        net->hear(net, from->node, end->node, &net->msg, true);
}

/* Bytes arrive; or, if there are none, the end of the connection. */
static void
arrive(void *arg, struct event *e)
{
    struct net *net = arg;
    struct net_end *end = &net->links[e->n]->end[e->k];
    const uint8_t *p = e->bytes;
    size_t left = e->len;

    if (!end->open || !net->ops[end->node] || (end->deaf && left > 0))
        return;
    if (left == 0) {
        end->open = false;
        net->ops[end->node]->closed(net, end->node, end->conn);
        return;
    }
    while (left > 0 && end->open && !end->deaf &&
           end->reader.session != MSG_NSESSION) {
        struct rad_error err = { 0 };
        size_t piece = 1 + net_random(net, 4096), rest;
        int rc;

        if (piece > left)
            piece = left;
        rest = piece;
        rc = frame_read(&end->reader, &p, &rest, &net->msg, &err);
        left -= piece - rest;
        if (rc < 0)
            net_fail(net, "frame", end->node, err.what);
        if (rc == 1)
            hear(net, net->links[e->n], e->k);
    }
}

static struct event *
to_other(struct net *net, int link, int side)
{
    struct net_end *other = &net->links[link]->end[!side];
    struct event e = {
        .at = net->now_ms + net_random(net, net->most_delay_ms + 1),
        .fn = arrive,
        .n = (uint64_t)link,
        .k = !side,
    };

    if (e.at < other->busy_ms)
        e.at = other->busy_ms;
    other->busy_ms = e.at;
    return events_add(&net->events, &e);
}

/* Let a HELLO offer versions up to `most`. */
static void
set_offer(uint8_t *hello, unsigned most)
{
    hello[MSG_HEADER + 2] = (uint8_t)(most >> 8); /* the HELLO's `max` */
    hello[MSG_HEADER + 3] = (uint8_t)most;
}

void
net_send(struct net *net, int node, uint64_t conn, const uint8_t *bytes,
         size_t len)
{
    struct event *e;
    struct wire_out out;
    int link, side;

    /* a machine must not send on a connection that it knows is closed */
    SIM_CHECK(net, find(net, node, conn, &link, &side) != NULL);
    wire_out_init(&out, MSG_FRAME_MAX);
    wire_put_bytes(&out, bytes, len);
    SIM_CHECK(net, !out.bad);
    if (msg_frame_type(bytes, len) == MSG_HELLO)
        set_offer(out.buf, net->offers[node]);
    e = to_other(net, link, side);
    e->bytes = out.buf; /* taken: instead of wire_out_release() */
    e->len = out.len;
}

void
net_send_msg(struct net *net, int node, uint64_t conn, const struct msg *m)
{
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    SIM_CHECK(net, msg_pack(&out, m) == 0);
    net_send(net, node, conn, out.buf, out.len);
    wire_out_release(&out);
}

void
net_session(struct net *net, int node, uint64_t conn, enum msg_session session,
            unsigned version)
{
    struct net_end *e = net_find(net, node, conn);

    SIM_CHECK(net, e != NULL);
    e->reader.session = session;
    e->reader.version = version;
}

void
net_close(struct net *net, int node, uint64_t conn)
{
    int link, side;
    struct net_end *e = find(net, node, conn, &link, &side);

    SIM_CHECK(net, e != NULL);
    e->open = false;
    to_other(net, link, side);
}

static bool
is_between(const struct net_link *l, int node, int first, int last)
{
    for (int s = 0; s < 2; s++)
        if (l->end[s].node == node && l->end[!s].node >= first &&
            l->end[!s].node <= last)
            return l->end[0].open && l->end[1].open && !l->end[0].deaf;
    return false;
}

unsigned
net_cut(struct net *net, int node, int first, int last)
{
    unsigned n = 0;
    struct net_link *l = NULL;
    int link = 0;

    for (size_t i = 0; i < net->nlinks; i++)
        if (is_between(net->links[i], node, first, last) &&
            net_random(net, ++n) == 0) {
            l = net->links[i];
            link = (int)i;
        }
    if (!l)
        return 0;
    l->end[0].deaf = l->end[1].deaf = true;
    to_other(net, link, 0);
    to_other(net, link, 1);
    return 1;
}

void
net_hold(struct net *net, int node, unsigned ms, bool to, bool from)
{
    uint64_t until = net->now_ms + ms;

    for (size_t i = 0; i < net->nlinks; i++)
        for (int s = 0; s < 2; s++) {
            struct net_link *l = net->links[i];
            bool hit = (to && l->end[s].node == node) ||
                       (from && l->end[!s].node == node);

            if (hit && l->end[s].busy_ms < until)
                l->end[s].busy_ms = until;
        }
}

void
net_close_all(struct net *net, int node)
{
    for (size_t i = 0; i < net->nlinks; i++)
        for (int s = 0; s < 2; s++)
            if (net->links[i]->end[s].open &&
                net->links[i]->end[s].node == node) {
                net->links[i]->end[s].open = false;
                to_other(net, (int)i, s);
            }
}
