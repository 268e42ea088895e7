/* host_radd.c - a host's radd: the real machine (daemon/worker/worker.h), and
 * what its shell does: the child's messages, links to other hosts */
#include "config.h"

#include "host_impl.h"

#include "worker/worker.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HANDSHAKE 3 /* latencies until a link is open */

/* One end of a link between two hosts. */
struct peer_end {
    struct peer_end *next; /* of the host's, newest first */
    struct peer_end *other;
    struct host *host;
    uint64_t conn;
    bool open;
};

static struct peer_end *
find_end(const struct host *h, uint64_t conn)
{
    struct peer_end *end = h->ends;

    while (end && (end->conn != conn || !end->open))
        end = end->next;
    return end;
}

static struct peer_end *
new_end(struct host *h, uint64_t conn)
{
    struct peer_end *end = sim_alloc(sizeof *end);

    *end = (struct peer_end){ h->ends, NULL, h, conn, true };
    h->ends = end;
    return end;
}

static void act(struct host *h);

/* --- links end --- */

static void
at_end(void *arg, struct event *e)
{
    struct peer_end *end = (struct peer_end *)(uintptr_t)e->n;

    (void)arg;
    if (!end->open)
        return;
    end->open = false;
    worker_closed(end->host->radd, cluster_ms(end->host->cluster), end->conn,
                  "closed");
    act(end->host);
}

static void
close_end(struct peer_end *end)
{
    const struct cluster *c = end->host->cluster;
    struct event e = { .at = c->now_us + (uint64_t)c->spec->latency_us,
                       .fn = at_end,
                       .n = (uintptr_t)end->other };

    end->open = false;
    events_add(&end->host->cluster->events, &e);
}

/* --- messages go --- */

static void
at_child(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);

    if (h)
        host_child_message(h, cluster_decode(arg, e->bytes, e->len));
}

static void
at_peer(void *arg, struct event *e)
{
    const struct peer_end *end = (const struct peer_end *)(uintptr_t)e->n;

    if (!end->open)
        return;
    worker_message(end->host->radd, cluster_ms(arg), end->conn,
                   cluster_decode(arg, e->bytes, e->len));
    act(end->host);
}

static void
send_child(struct host *h, const struct action *a)
{
    struct event e = { .at = h->cluster->now_us,
                       .fn = at_child,
                       .node = h->number,
                       .n = h->life };

    event_take(&e, a->bytes, a->len);
    events_add(&h->cluster->events, &e);
}

static void
send_out(struct host *h, const struct action *a)
{
    const struct peer_end *end;

    if (a->conn == h->child) {
        send_child(h, a);
    } else if (a->conn == h->own) {
        cluster_send(h->cluster, h->number, a->bytes, a->len);
    } else if ((end = find_end(h, a->conn))) {
        struct event e = { .fn = at_peer, .n = (uintptr_t)end->other };

        cluster_send_peer(h->cluster, h->number, &e, a->bytes, a->len);
        worker_written(h->radd, cluster_ms(h->cluster), a->conn, a->len);
    }
}

/* --- dialling --- */

static void
dialled(void *arg, struct event *e)
{
    struct cluster *c = arg;
    struct host *h = host_alive(arg, e), *to;
    uint64_t conn = e->len;
    struct peer_end *end;

    if (!h)
        return;
    if (e->k < 0) {
        h->own = conn;
        cluster_open(c, h->number);
    } else {
        to = host_at(c, e->k);
        if (!to->radd) {
            worker_closed(h->radd, cluster_ms(c), conn, "refused");
            act(h);
            return;
        }
        end = new_end(h, conn);
        end->other = new_end(to, ++c->next_conn);
        end->other->other = end;
        worker_accepted(to->radd, cluster_ms(c), end->other->conn);
        act(to);
    }
    worker_opened(h->radd, cluster_ms(c), conn);
    act(h);
}

static void
dial(const struct host *h, const struct action *a)
{
    struct cluster *c = h->cluster;
    struct event e = { .at = c->now_us +
                             (uint64_t)(HANDSHAKE * c->spec->latency_us),
                       .fn = dialled,
                       .node = h->number,
                       .n = h->life,
                       .k = a->text[0] ? atoi(a->text + strlen("sim ")) : -1,
                       .len = a->conn };

    events_add(&c->events, &e);
}

/* --- what the machine wants --- */

static void
carry_out(struct host *h, const struct action *a)
{
    struct peer_end *end;

    switch (a->type) {
    case ACT_SEND:
        send_out(h, a);
        break;
    case ACT_DIAL:
        dial(h, a);
        break;
    case ACT_CLOSE:
        if ((end = find_end(h, a->conn)))
            close_end(end);
        break;
    case ACT_SPAWN:
        h->child = a->conn;
        break;
    case ACT_KILL:
        h->child = 0;
        host_child_over(h);
        break;
    case ACT_LOG:
        if (h->cluster->spec->verbose || a->level == ACT_ERR)
            printf("%10.6f %s %s\n", 1e-6 * (double)h->cluster->now_us, h->name,
                   a->text);
        break;
    default:
        break; /* no sessions, no files */
    }
}

static void
act(struct host *h)
{
    struct action_list *l = worker_actions(h->radd);

    for (size_t i = 0; i < l->n; i++) {
        struct action a = l->v[i];

        carry_out(h, &a);
    }
    if (l->failed) {
        fprintf(stderr, "sim: %s is out of memory\n", h->name);
        abort();
    }
    actions_clear(l);
}

void
host_say(struct host *h, const struct msg *m)
{
    worker_message(h->radd, cluster_ms(h->cluster), h->child, m);
    act(h);
}

void
host_message(struct cluster *c, struct host *h, const struct msg *m)
{
    worker_message(h->radd, cluster_ms(c), h->own, m);
    act(h);
}

void
host_tick(struct cluster *c, struct host *h)
{
    if (!h->radd)
        return;
    worker_tick(h->radd, cluster_ms(c));
    act(h);
}

/* --- its life --- */

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    (void)arg;
    (void)hash;
    return true;
}

void
host_start(struct cluster *c, struct host *h)
{
    const struct worker_env env = { .has_file = has_file,
                                    .random = cluster_bytes,
                                    .arg = c,
                                    .program = "sim",
                                    .name = h->name,
                                    .coordinator = "sim",
                                    .address = h->address,
                                    .threads = (unsigned)c->spec->threads };

    h->radd = worker_new(&env);
    if (!h->radd)
        abort();
    worker_start(h->radd, cluster_ms(c));
    act(h);
}

void
host_radd_dies(struct host *h)
{
    for (struct peer_end *end = h->ends; end; end = end->next)
        if (end->open)
            close_end(end);
    worker_free(h->radd);
    h->radd = NULL;
    h->own = h->child = 0;
}

void
host_radd_release(struct host *h)
{
    worker_free(h->radd);
    while (h->ends) {
        struct peer_end *end = h->ends;

        h->ends = end->next;
        free(end);
    }
}
