/* child.c - a job's child, played: it loads, renders units in parallel, makes
 * ambient records, and sometimes dies */
#include "config.h"

#include "cluster.h"

#include "picture/quincunx.h"

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

/* --- lines of strict units --- */

static struct rad_quincunx
sampler(const struct sim_child *k, struct net *net, uint32_t frame)
{
    const struct msg_frame *f = &of(net)->job[k->job].frame[frame];
    struct rad_quincunx q = { .width = (int)f->width,
                              .height = (int)f->height };

    rad_quincunx_steps(SIM_PSAMPLE, &q.xstep, &q.ystep);
    return q;
}

/* The line whose base line is that row. */
static int
line_of_row(const struct rad_quincunx *q, uint32_t row)
{
    int i = 0;

    while (rad_quincunx_base_row(q, i) != (int)row)
        i++;
    return i;
}

/* Is the base line above a unit there? */
static bool
has_top(const struct sim_child *k, struct net *net, const struct msg_unit *u)
{
    struct rad_quincunx q = sampler(k, net, u->frame);
    const struct sim_line *l;

    if (u->mode == MSG_MODE_WINDOW || u->y == 0)
        return true;
    l = &k->line[u->frame][line_of_row(&q, u->y - 1)];
    for (int x = 0; x < q.width; x++)
        if (!l->pixel[x])
            return false;
    for (size_t i = 0; i < rad_quincunx_ndensity(&q); i++)
        if (!l->density[i])
            return false;
    return true;
}

/* A piece of the base line under a unit. */
static void
send_piece(struct net *net, int node, const struct msg_unit *u, int line,
           uint32_t x, uint32_t n, uint32_t first, uint32_t nd)
{
    struct sim_child *k = child_of(net, node);
    uint8_t density[SIM_SIDE], bytes[SIM_SIDE * 12];
    float v[SIM_SIDE * 3];
    struct msg m = { .type = MSG_BASE_LINE };

    for (uint32_t i = 0; i < n; i++) {
        v[3 * i] = (float)(x + i);
        v[3 * i + 1] = (float)(u->y + u->height - 1);
        v[3 * i + 2] = 0;
    }
    wire_floats_put(bytes, v, (size_t)n * 3);
    for (uint32_t i = 0; i < nd; i++)
        density[i] = (uint8_t)(first + i);
    m.base_line = (struct msg_base_line){ of(net)->job[k->job].id,
                                          u->frame,
                                          (uint32_t)line,
                                          x,
                                          n,
                                          first,
                                          nd,
                                          3,
                                          density,
                                          bytes };
    net_send_msg(net, node, k->conn, &m);
}

/* All of it, in pieces; the child has it itself, too. */
static void
send_bottom(struct net *net, int node, const struct msg_unit *u)
{
    struct sim_child *k = child_of(net, node);
    struct rad_quincunx q = sampler(k, net, u->frame);
    uint32_t width = (uint32_t)q.width, x = 0, first = 0;
    uint32_t nd = (uint32_t)rad_quincunx_ndensity(&q);
    int line = line_of_row(&q, u->y + u->height - 1);

    while (x < width || first < nd) {
        uint32_t n = x < width ? 1 + net_random(net, width - x) : 0;
        uint32_t d = first < nd ? 1 + net_random(net, nd - first) : 0;

        send_piece(net, node, u, line, x, n, first, d);
        x += n;
        first += d;
    }
    memset(&k->line[u->frame][line], 1, sizeof k->line[0][0]);
}

static void
take_base_line(struct net *net, struct sim_child *k,
               const struct msg_base_line *m)
{
    struct rad_quincunx q = sampler(k, net, m->frame);
    struct sim_line *l = &k->line[m->frame][m->line];

    for (uint32_t i = 0; i < m->n; i++) {
        float v[3];

        wire_floats_get(v, m->pixels + (size_t)i * 12, 3);
        SIM_CHECK(net, v[0] == (float)(m->x + i));
        SIM_CHECK(net, v[1] == (float)rad_quincunx_base_row(&q, (int)m->line));
        l->pixel[m->x + i] = 1;
    }
    for (uint32_t i = 0; i < m->ndensity; i++) {
        SIM_CHECK(net, m->density[i] == m->first + i);
        l->density[m->first + i] = 1;
    }
}

/* --- units --- */

static void
say_attempt(struct net *net, int node, uint16_t type, const struct msg_unit *u)
{
    struct sim_child *k = child_of(net, node);
    struct msg m = { .type = type };

    m.parked =
        (struct msg_attempt){ of(net)->job[k->job].id, u->unit, u->attempt };
    net_send_msg(net, node, k->conn, &m);
}

static struct sim_unit *
find_unit(struct sim_child *k, uint32_t unit, uint32_t attempt)
{
    for (unsigned i = 0; i < k->nqueue; i++)
        if (k->queue[i].unit.unit == unit &&
            k->queue[i].unit.attempt == attempt)
            return &k->queue[i];
    return NULL;
}

static void
drop_unit(struct sim_child *k, struct sim_unit *u)
{
    unsigned i = (unsigned)(u - k->queue);

    k->running -= u->running;
    memmove(u, u + 1, (--k->nqueue - i) * sizeof *u);
}

/* Facts of some pixel of the unit, which others may want. */
static void
send_facts(struct net *net, int node, const struct msg_unit *u)
{
    static const uint8_t pixel[12];
    struct sim_child *k = child_of(net, node);
    struct rad_quincunx q = sampler(k, net, u->frame);
    uint8_t bitmap[(SIM_SIDE + 7) / 8] = { 1 };
    int line = line_of_row(&q, u->y + u->height - 1);
    struct msg m = { .type = MSG_FACTS };

    m.facts = (struct msg_facts){ .job = of(net)->job[k->job].id,
                                  .frame = u->frame,
                                  .line = (uint32_t)line,
                                  .rows = 1,
                                  .width = (uint32_t)q.width,
                                  .channels = 3,
                                  .bitmap = bitmap,
                                  .pixels = pixel };
    net_send_msg(net, node, k->conn, &m);
}

static void
finish(struct net *net, int node, struct sim_unit *su)
{
    struct sim *s = of(net);
    struct sim_child *k = child_of(net, node);
    struct msg_unit u = su->unit;
    uint32_t row = 0;

    drop_unit(k, su);
    if (u.mode == MSG_MODE_STRICT)
        send_bottom(net, node, &u);
    while (row < u.height) {
        uint32_t rows = 1 + net_random(net, u.height - row);

        send_rows(net, node, &u, row, rows);
        row += rows;
    }
    k->busy_s += .01;
    send_tally(net, node);
    if ((s->job[k->job].spec.flags & MSG_JOB_SHARE) && net_chance(net, 2))
        send_ambient(net, node, 0);
}

/* Finish what was only waiting. */
static void
look(struct net *net, int node)
{
    struct sim_child *k = child_of(net, node);

    for (unsigned i = 0; i < k->nqueue;)
        if (k->queue[i].ahead && has_top(k, net, &k->queue[i].unit)) {
            finish(net, node, &k->queue[i]);
            i = 0; /* its bottom may be the top of another */
        } else {
            i++;
        }
}

static void
worked(struct net *net, struct net_event *e)
{
    struct sim *s = of(net);
    struct sim_child *k;
    const struct msg_unit *key = (const struct msg_unit *)(void *)e->data;
    struct sim_unit *u;

    if (!alive(net, e))
        return;
    k = child_of(net, e->a);
    u = find_unit(k, key->unit, key->attempt);
    if (!u)
        return; /* revoked */
    if (key->unit == s->job[k->job].poison ||
        (!s->calm && s->job[k->job].crashes == 0 && net_chance(net, 60))) {
        die(net, e->a);
        return;
    }
    u->running = false;
    u->ahead = true;
    k->running--;
    if (!has_top(k, net, &u->unit)) {
        send_facts(net, e->a, &u->unit);
        say_attempt(net, e->a, MSG_PARKED, &u->unit);
        s->parked++;
    }
    look(net, e->a);
    render_next(net, e->a);
}

/* Start as many units as there are threads. */
static void
render_next(struct net *net, int node)
{
    struct sim_child *k = child_of(net, node);

    for (unsigned i = 0;
         i < k->nqueue && k->running < of(net)->worker[k->worker].threads;
         i++) {
        struct net_event *e;

        if (k->queue[i].running || k->queue[i].ahead)
            continue;
        k->queue[i].running = true;
        k->running++;
        e = later(net, node, 1 + net_random(net, 200), worked);
        e->data = malloc(sizeof(struct msg_unit));
        SIM_CHECK(net, e->data != NULL);
        memcpy(e->data, &k->queue[i].unit, sizeof(struct msg_unit));
    }
}

/* Give the lower half of a unit that is not far. */
static void
split(struct net *net, int node, const struct msg_attempt *m)
{
    struct sim_child *k = child_of(net, node);
    struct sim_unit *u = find_unit(k, m->unit, m->attempt);
    struct msg gave = { .type = MSG_GAVE };

    if (!u)
        return;
    if (!u->ahead && !net_chance(net, 5)) {
        struct rad_quincunx q = sampler(k, net, u->unit.frame);
        int last = line_of_row(&q, u->unit.y + u->unit.height - 1);
        int first = u->unit.y == 0 ? 0 : line_of_row(&q, u->unit.y - 1) + 1;

        u->unit.height =
            (uint32_t)rad_quincunx_base_row(&q, (first + last) / 2) + 1 -
            u->unit.y;
        of(net)->gave += last > first;
    }
    gave.gave = (struct msg_gave){ of(net)->job[k->job].id, m->unit, m->attempt,
                                   u->unit.height };
    net_send_msg(net, node, k->conn, &gave);
}

static void
estimate(struct net *net, int node, const struct msg_estimate *m)
{
    struct sim_child *k = child_of(net, node);
    struct msg_cost *v = calloc(m->nareas + 1, sizeof *v);
    struct msg done = { .type = MSG_ESTIMATED };

    SIM_CHECK(net, v != NULL);
    for (uint32_t i = 0; i < m->nareas; i++)
        v[i].rays = v[i].tests = 1 + m->areas[i].y % 7;
    of(net)->estimates++;
    done.estimated.job = of(net)->job[k->job].id;
    done.estimated.id = m->id;
    done.estimated.ncosts = m->nareas;
    done.estimated.costs = v;
    net_send_msg(net, node, k->conn, &done);
    free(v);
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
revoke(struct net *net, int node, const struct msg_attempt *r)
{
    struct sim_child *k = child_of(net, node);
    struct sim_unit *u = find_unit(k, r->unit, r->attempt);

    if (!u)
        return;
    drop_unit(k, u);
    render_next(net, node);
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
        SIM_CHECK(net, k->nqueue < sizeof k->queue / sizeof k->queue[0]);
        k->queue[k->nqueue++] = (struct sim_unit){ .unit = m->unit };
        render_next(net, node);
        break;
    case MSG_REVOKE:
        revoke(net, node, &m->revoke);
        break;
    case MSG_SPLIT:
        split(net, node, &m->split);
        break;
    case MSG_TWIN:
        of(net)->twins++;
        break;
    case MSG_BASE_LINE:
        take_base_line(net, k, &m->base_line);
        look(net, node);
        break;
    case MSG_ESTIMATE:
        estimate(net, node, &m->estimate);
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
