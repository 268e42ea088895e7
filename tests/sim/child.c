/* child.c - a job's child, played: it loads, renders units in parallel, makes
 * ambient records, and sometimes dies */
#include "config.h"

#include "cluster.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct sim *
of(struct net *net)
{
    return (struct sim *)net;
}

static struct sim_child *
child_of(struct net *net, int node)
{
    return &of(net)->child[node - NODE_CHILD];
}

static void
die(struct net *net, int node)
{
    struct sim *s = of(net);

    s->crashes++;
    s->job[child_of(net, node)->job].crashes++;
    net->ops[node] = NULL;
    net_close_all(net, node);
}

/* The link of a child that is still the same one. */
static bool
alive(struct net *net, const struct net_event *e)
{
    return net->ops[e->a] && child_of(net, e->a)->conn == e->c;
}

static struct net_event *
later(struct net *net, int node, unsigned delay,
      void (*fn)(struct net *net, struct net_event *e))
{
    struct net_event *e = net_later(net, delay, fn);

    e->a = node;
    e->c = child_of(net, node)->conn;
    return e;
}

static void
send_rows(struct net *net, int node, const struct msg_unit *u, uint32_t row,
          uint32_t rows)
{
    const struct sim_child *k = child_of(net, node);
    size_t n = (size_t)rows * u->width * 3;
    float *v = malloc(n * sizeof *v), *p = v;
    uint8_t *bytes = malloc(4 * n);
    struct msg m = { .type = MSG_RESULT };

    SIM_CHECK(net, v && bytes);
    for (uint32_t y = row; y < row + rows; y++)
        for (uint32_t x = 0; x < u->width; x++) {
            *p++ = (float)(u->x + x);
            *p++ = (float)(u->y + y);
            *p++ = (float)u->attempt;
        }
    wire_floats_put(bytes, v, n);
    m.result = (struct msg_result){ of(net)->job[k->job].id,
                                    u->unit,
                                    u->attempt,
                                    row,
                                    rows,
                                    u->width,
                                    3,
                                    row + rows == u->height,
                                    { .rays = u->width * u->height,
                                      .primary_rays = u->width * u->height,
                                      .cpu_s = .01 },
                                    bytes };
    net_send_msg(net, node, k->conn, &m);
    free(v);
    free(bytes);
}

static void
send_tally(struct net *net, int node)
{
    struct sim_child *k = child_of(net, node);
    struct msg m = { .type = MSG_TALLY,
                     .tally = { .job = of(net)->job[k->job].id,
                                .ambient_sent = k->nambient,
                                .busy_s = k->busy_s,
                                .wait_base_line_s = k->busy_s / 4 } };

    net_send_msg(net, node, k->conn, &m);
}

static void
send_ambient(struct net *net, int node, uint32_t to)
{
    struct sim_child *k = child_of(net, node);
    uint8_t data[2] = { (uint8_t)k->worker, (uint8_t)k->job };
    struct msg m = { .type = MSG_AMBIENT, .ambient = { to, 1, data, 2 } };

    k->nambient++;
    net_send_msg(net, node, k->conn, &m);
}

static void render_next(struct net *net, int node);

static void
finish(struct net *net, struct net_event *e)
{
    struct sim *s = of(net);
    struct sim_child *k;
    const struct msg_unit *u = (const struct msg_unit *)(void *)e->data;
    uint32_t row = 0;

    if (!alive(net, e))
        return;
    k = child_of(net, e->a);
    if (u->unit == s->job[k->job].poison ||
        (!s->calm && s->job[k->job].crashes == 0 && net_chance(net, 60))) {
        die(net, e->a);
        return;
    }
    while (row < u->height) {
        uint32_t rows = 1 + net_random(net, u->height - row);

        send_rows(net, e->a, u, row, rows);
        row += rows;
    }
    k->busy_s += .01;
    k->running--;
    send_tally(net, e->a);
    if ((s->job[k->job].spec.flags & MSG_JOB_SHARE) && net_chance(net, 2))
        send_ambient(net, e->a, 0);
    render_next(net, e->a);
}

/* Start as many units as there are threads. */
static void
render_next(struct net *net, int node)
{
    struct sim_child *k = child_of(net, node);

    while (k->nqueue > 0 && k->running < of(net)->worker[k->worker].threads) {
        struct net_event *e =
            later(net, node, 1 + net_random(net, 200), finish);

        e->data = malloc(sizeof(struct msg_unit));
        SIM_CHECK(net, e->data != NULL);
        memcpy(e->data, &k->queue[0].unit, sizeof(struct msg_unit));
        memmove(k->queue, k->queue + 1, --k->nqueue * sizeof k->queue[0]);
        k->running++;
    }
}

static void
ready(struct net *net, struct net_event *e)
{
    struct sim_child *k = child_of(net, e->a);
    struct msg m = { .type = MSG_READY };

    if (!alive(net, e))
        return;
    m.ready =
        (struct msg_ready){ of(net)->job[k->job].id, .05, 42,
                            (uint16_t)of(net)->worker[k->worker].threads };
    net_send_msg(net, e->a, k->conn, &m);
}

static void
revoke(struct sim_child *k, const struct msg_attempt *r)
{
    for (unsigned i = 0; i < k->nqueue; i++)
        if (k->queue[i].unit.unit == r->unit &&
            k->queue[i].unit.attempt == r->attempt) {
            memmove(k->queue + i, k->queue + i + 1,
                    (--k->nqueue - i) * sizeof k->queue[0]);
            return;
        }
}

static void
message(struct net *net, int node, uint64_t conn, const struct msg *m)
{
    struct sim_child *k = child_of(net, node);

    switch (m->type) {
    case MSG_JOB_START:
        SIM_CHECK(net, !k->started);
        k->started = true;
        k->job = sim_find_job(of(net), m->job_start.job);
        net_session(net, node, conn, MSG_AT_CHILD);
        later(net, node, net_random(net, 300), ready);
        break;
    case MSG_UNIT:
        SIM_CHECK(net, k->nqueue < 64);
        k->queue[k->nqueue++].unit = m->unit;
        render_next(net, node);
        break;
    case MSG_REVOKE:
        revoke(k, &m->revoke);
        break;
    case MSG_GIVE:
        send_ambient(net, node, m->give.to);
        break;
    case MSG_AMBIENT: /* of the same job, and never one's own */
        SIM_CHECK(net, m->ambient.len == 2);
        SIM_CHECK(net, m->ambient.data[0] != k->worker);
        SIM_CHECK(net, m->ambient.data[1] == k->job);
        break;
    }
}

/* Its radd is gone. */
static void
closed(struct net *net, int node, uint64_t conn)
{
    (void)conn;
    net->ops[node] = NULL;
}

const struct node_ops sim_child_ops = { message, closed };

void
sim_spawn(struct sim *s, int worker, uint64_t conn)
{
    struct net *net = &s->net;
    int i = 0;

    while (i < SIM_CHILDREN && net->ops[NODE_CHILD + i])
        i++;
    SIM_CHECK(net, i < SIM_CHILDREN);
    memset(&s->child[i], 0, sizeof s->child[i]);
    s->child[i].worker = worker;
    s->child[i].conn = ++net->next_conn;
    net->ops[NODE_CHILD + i] = &sim_child_ops;
    net_join(net, NODE_WORKER + worker, conn, NODE_CHILD + i, s->child[i].conn,
             MSG_AT_PARENT_NEW, MSG_AT_CHILD_NEW);
}

/* SIGKILL: nothing that it says later counts. */
void
sim_kill(struct sim *s, int worker, uint64_t conn)
{
    if (net_find(&s->net, NODE_WORKER + worker, conn))
        net_close(&s->net, NODE_WORKER + worker, conn);
}
