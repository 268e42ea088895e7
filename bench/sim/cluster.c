/* cluster.c - see cluster.h */
#include "config.h"

#include "cluster.h"

#include "host.h"

#include "base/rng.h"
#include "proto/frame.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* A job that takes so many times what one host would is stuck. */
#define STUCK 20

#define TICK_US 100000

/* Bytes that the coordinator decrypts in a microsecond (doc/performance.md). */
#define DECRYPTED 1900.
#define CLIENT  -1 /* in place of a host's number */

uint64_t
cluster_ms(const struct cluster *c)
{
    return 1000 + c->now_us / 1000; /* 0 means never */
}

double
cluster_random(struct cluster *c)
{
    return rad_rand(c->spec->seed, (uint32_t)c->random++ & 0x7fffffff);
}

void
cluster_bytes(void *arg, void *buf, size_t n)
{
    struct cluster *c = arg;
    uint8_t *p = buf;

    while (n-- > 0)
        *p++ = (uint8_t)(256 * cluster_random(c));
}

static void
later(struct cluster *c, double delay_us, int host, uint64_t n,
      void (*fn)(void *arg, struct event *e))
{
    struct event e = {
        .at = c->now_us + (uint64_t)delay_us, .fn = fn, .node = host, .n = n
    };

    events_add(&c->events, &e);
}

/* --- the coordinator --- */

static void coordinate(struct cluster *c);

bool
cluster_first(struct cluster *c, uint32_t pass, uint32_t tile)
{
    bool first = !c->made[pass][tile];

    c->made[pass][tile] = true;
    return first;
}

/* How long coord.c takes, in all. */
static double
processor_s(void)
{
    struct timespec t;

    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Cut a frame's header off and decode the rest. */
const struct msg *
cluster_decode(struct cluster *c, const uint8_t *b, size_t len)
{
    uint16_t type = (uint16_t)(b[4] << 8 | b[5]);
    uint32_t request = (uint32_t)b[8] << 24 | (uint32_t)b[9] << 16 |
                       (uint32_t)b[10] << 8 | b[11];
    struct rad_error err = { 0 };

    if (msg_unpack(&c->msg, type, request, b + MSG_HEADER, len - MSG_HEADER,
                   &err) < 0) {
        fprintf(stderr, "sim: %s: %s\n", msg_name(type), err.what);
        abort();
    }
    return &c->msg;
}

static void
tell(const struct cluster *c, const char *to, const struct msg *m)
{
    if (c->spec->verbose)
        printf("%10.6f %s %s\n", 1e-6 * (double)c->now_us, to,
               msg_name(m->type));
}

static void
at_coordinator(void *arg, struct event *e)
{
    struct cluster *c = arg;
    double begin = processor_s();

    cluster_decode(c, e->bytes, e->len);
    tell(c, "coord", &c->msg);
    coord_message(c->coord, cluster_ms(c), e->n, &c->msg);
    c->out->coord_s += processor_s() - begin;
    coordinate(c);
}

/* When so many bytes are through a link, whose time moves on. */
static uint64_t
through(const struct cluster *c, uint64_t *link_us, size_t len)
{
    if (*link_us < c->now_us)
        *link_us = c->now_us;
    *link_us += (uint64_t)(1e6 * (double)len / c->spec->bandwidth);
    return *link_us;
}

/* The coordinator's line takes one message after the other, and so does the
 * coordinator, which reads and decrypts what is there while more comes. */
static void
reach_coordinator(void *arg, struct event *e)
{
    struct cluster *c = arg;
    struct event then = *e;
    uint64_t begin = through(c, &c->coord_in_us, e->len);

    if (begin < c->coord_busy_us)
        begin = c->coord_busy_us;
    c->coord_busy_us =
        begin + (uint64_t)(c->spec->coord_us + (double)e->len / DECRYPTED);
    then.at = c->coord_busy_us;
    then.fn = at_coordinator;
    events_add(&c->events, &then);
    e->bytes = NULL; /* went along */
}

/* *e with a copy of a message. */
static struct event
carrying(struct cluster *c, struct event e, const uint8_t *bytes, size_t len)
{
    uint16_t type = msg_frame_type(bytes, len);

    c->out->messages++;
    c->out->bytes += len;
    if (type == MSG_BASE_LINE)
        c->out->base_line_bytes += len;
    if (type == MSG_TILE_MADE)
        c->out->tile_bytes += len;
    if (type == MSG_TILE_RECORDS)
        c->out->peer_bytes += len;
    event_take(&e, bytes, len);
    return e;
}

static void
to_coordinator(struct cluster *c, uint64_t conn, uint64_t *link_us,
               const uint8_t *bytes, size_t len)
{
    struct event e = { .fn = reach_coordinator, .n = conn };

    e = carrying(c, e, bytes, len);
    e.at = through(c, link_us, e.len) + (uint64_t)c->spec->latency_us;
    events_add(&c->events, &e);
}

void
cluster_send(struct cluster *c, int host, const uint8_t *bytes, size_t len)
{
    struct cluster_link *l = &c->link[host];

    to_coordinator(c, l->conn, &l->up_us, bytes, len);
}

void
cluster_send_peer(struct cluster *c, int host, const struct event *to,
                  const uint8_t *bytes, size_t len)
{
    struct event e = carrying(c, *to, bytes, len);

    e.at = through(c, &c->link[host].peer_us, e.len) +
           (uint64_t)c->spec->latency_us;
    events_add(&c->events, &e);
}

/* --- hosts and the client --- */

static void
at_host(void *arg, struct event *e)
{
    struct cluster *c = arg;
    char name[32];

    if (e->n != c->link[e->node].conn)
        return; /* it died meanwhile */
    cluster_decode(c, e->bytes, e->len);
    snprintf(name, sizeof name, "w%d", e->node);
    tell(c, name, &c->msg);
    host_message(c, host_at(c, e->node), &c->msg);
}

static void
at_client(void *arg, struct event *e)
{
    struct cluster *c = arg;

    cluster_decode(c, e->bytes, e->len);
    tell(c, "client", &c->msg);
    if (c->msg.type == MSG_DONE) {
        c->out->done = c->over = true;
        c->out->seconds = 1e-6 * (double)(c->now_us - c->start_us);
    } else if (c->msg.type == MSG_FAILED) {
        c->over = true;
        snprintf(c->out->text, sizeof c->out->text, "%s", c->msg.failed.text);
    }
}

static int
host_of(const struct cluster *c, uint64_t conn)
{
    int host = (int)(conn % 65536);

    return conn == c->client || host >= c->spec->hosts ||
                   c->link[host].conn != conn
               ? CLIENT
               : host;
}

/* --- what the coordinator wants --- */

/* Count records that go out, and see which pass is closed now. */
static void
note_records(struct cluster *c, const struct action *a)
{
    uint16_t type = (uint16_t)(a->bytes[4] << 8 | a->bytes[5]);
    uint32_t open = c->passes;

    if (type == MSG_FROZEN)
        c->out->frozen_bytes += a->len;
    if (type == MSG_TILE_RECORDS)
        c->out->records_bytes += a->len;
    if (type != MSG_CLOSED)
        return;
    cluster_decode(c, a->bytes, a->len);
    if (c->msg.closed.pass != open)
        return;
    c->closed_us[open] = c->now_us;
    c->out->passes_s = 1e-6 * (double)(c->now_us - c->start_us);
    c->passes++;
}

static void
send_out(struct cluster *c, const struct action *a)
{
    int host = host_of(c, a->conn);
    struct event e = { .fn = host == CLIENT ? at_client : at_host,
                       .node = host,
                       .n = a->conn };
    uint64_t at = through(c, &c->coord_out_us, a->len);

    if (host == CLIENT && a->conn != c->client)
        return; /* a host that died */
    if (host != CLIENT) {
        uint64_t *down = &c->link[host].down_us;

        if (at < *down)
            at = *down;
        *down = at;
    }
    c->out->messages++;
    c->out->bytes += a->len;
    note_records(c, a);
    event_take(&e, a->bytes, a->len);
    e.at = at + (uint64_t)c->spec->latency_us;
    events_add(&c->events, &e);
}

static void
job_opened(void *arg, struct event *e)
{
    struct cluster *c = arg;

    (void)e;
    coord_job_opened(c->coord, cluster_ms(c), c->job, c->sequence, 0, NULL);
    coordinate(c);
}

static void
rows_stored(void *arg, struct event *e)
{
    struct cluster *c = arg;
    struct action_rows rows;

    memcpy(&rows, e->bytes, sizeof rows);
    coord_rows_stored(c->coord, cluster_ms(c), &rows, 0, NULL);
    coordinate(c);
}

static void
picture_written(void *arg, struct event *e)
{
    struct cluster *c = arg;

    coord_picture_written(c->coord, cluster_ms(c), c->job, c->sequence,
                          (uint32_t)e->n, 0, NULL);
    coordinate(c);
}

static void
put_rows(struct cluster *c, const struct action *a)
{
    struct event e = { .fn = rows_stored };

    event_take(&e, &a->rows, sizeof a->rows);
    e.at = c->now_us + (uint64_t)c->spec->disk_us;
    if (e.at < c->disk_us)
        e.at = c->disk_us;
    c->disk_us = e.at;
    events_add(&c->events, &e);
}

static void
carry_out(struct cluster *c, const struct action *a)
{
    switch (a->type) {
    case ACT_SEND:
        send_out(c, a);
        break;
    case ACT_LOG:
        if (c->spec->verbose || a->level == ACT_ERR)
            printf("%10.6f %s\n", 1e-6 * (double)c->now_us, a->text);
        break;
    case ACT_JOB_OPEN:
        c->sequence = a->sequence;
        later(c, c->spec->disk_us, 0, 0, job_opened);
        break;
    case ACT_PUT_ROWS:
        put_rows(c, a);
        break;
    case ACT_WRITE_PICTURE:
        later(c, c->spec->disk_us, 0, a->frame, picture_written);
        break;
    default:
        break; /* no files, no other end */
    }
}

static void
coordinate(struct cluster *c)
{
    struct action_list *l = coord_actions(c->coord);

    for (size_t i = 0; i < l->n; i++)
        carry_out(c, &l->v[i]);
    if (l->failed) {
        fputs("sim: the coordinator is out of memory\n", stderr);
        abort();
    }
    actions_clear(l);
}

static void
tick(void *arg, struct event *e)
{
    struct cluster *c = arg;
    double begin = processor_s();

    (void)e;
    coord_tick(c->coord, cluster_ms(c));
    c->out->coord_s += processor_s() - begin;
    coordinate(c);
    for (int i = 0; i < c->spec->hosts; i++)
        host_tick(c, host_at(c, i));
    later(c, TICK_US, 0, 0, tick);
}

/* --- life --- */

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    (void)arg;
    (void)hash;
    return true;
}

/* From a host, or the client (number CLIENT). */
static uint64_t
open_conn(struct cluster *c, int host, enum msg_role role)
{
    const struct coord_peer peer = { "sim", "sim", 1u << role, NULL };
    uint64_t low = host == CLIENT ? 65535 : (uint64_t)host;
    uint64_t conn = ++c->next_conn << 16 | low;

    coord_opened(c->coord, cluster_ms(c), conn, &peer);
    coordinate(c);
    return conn;
}

void
cluster_open(struct cluster *c, int host)
{
    c->link[host].conn = open_conn(c, host, MSG_ROLE_WORKER);
}

/* The costs of the lines, as a former run's statistics would say. */
static uint8_t *
line_costs(const struct map *m, uint32_t *n)
{
    uint8_t *bytes, *to;

    *n = m->nframes * (uint32_t)m->nlines;
    bytes = to = sim_alloc(*n * sizeof(float));
    for (uint32_t k = 0; k < m->nframes; k++) {
        int y = 0;

        for (int i = 0; i < m->nlines; i++, to += sizeof(float)) {
            double sum = 0;
            float cost;

            for (; y <= rad_quincunx_base_row(&m->q, i); y++)
                sum += map_row(m, k, y, m->q.width);
            cost = (float)sum;
            wire_floats_put(to, &cost, 1);
        }
    }
    return bytes;
}

static void
client_says(struct cluster *c, const struct msg *m)
{
    uint64_t link_us = 0;
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    if (msg_pack(&out, m) < 0) {
        fprintf(stderr, "sim: %s cannot be packed\n", msg_name(m->type));
        abort();
    }
    to_coordinator(c, c->client, &link_us, out.buf, out.len);
    wire_out_release(&out);
}

static void
submit(struct cluster *c)
{
    const struct cluster_spec *s = c->spec;
    const struct map *m = s->map;
    uint8_t hash[MSG_HASH] = { 1 }, *costs = NULL;
    struct msg_frame *frames = sim_alloc(m->nframes * sizeof *frames);
    bool optimum = strcmp(s->estimate, "optimum") == 0;
    struct msg msg = { .type = MSG_SUBMIT, .request = 1 };
    char params[32];

    snprintf(params, sizeof params, "-ps %d", m->psample);
    for (uint32_t k = 0; k < m->nframes; k++)
        frames[k] = (struct msg_frame){ m->nframes > 1 ? k + 1 : 0,
                                        (uint32_t)m->q.width,
                                        (uint32_t)m->q.height, "-vtv" };
    msg.submit =
        (struct msg_spec){ .job = c->job,
                           .manifest = hash,
                           .name = "sim",
                           .params = s->tiles ? s->tiles->params : params,
                           .needs = "",
                           .estimate = optimum ? "uniform" : s->estimate,
                           .seed = s->seed,
                           .flags = s->flags | (s->tiles ? MSG_JOB_PASSES : 0),
                           .partition = (uint8_t)s->partition,
                           .order = (uint8_t)s->order,
                           .windows = s->windows,
                           .files = { 1, hash },
                           .nframes = m->nframes,
                           .frames = frames };
    if (optimum)
        costs = line_costs(m, &msg.submit.ncosts);
    msg.submit.costs = costs;
    c->start_us = c->now_us;
    coord_file_stored(c->coord, cluster_ms(c), c->client, hash);
    client_says(c, &msg);
    free(costs);
    free(frames);
}

static void
say_hello(struct cluster *c)
{
    struct msg m = { .type = MSG_HELLO,
                     .hello = { 1, 1, MSG_ROLE_USER, "", "sim", "", 0, 0 } };

    c->client = open_conn(c, CLIENT, MSG_ROLE_USER);
    client_says(c, &m);
}

static void
begin(void *arg, struct event *e)
{
    (void)e;
    submit(arg);
}

static void
fail_host(void *arg, struct event *e)
{
    struct cluster *c = arg;
    uint64_t conn = c->link[e->node].conn;

    if (conn != 0) {
        host_fail(c, host_at(c, e->node));
        c->link[e->node].conn = 0;
        coord_closed(c->coord, cluster_ms(c), conn, "reset");
        coordinate(c);
        c->out->failed++;
    }
    later(c, -log(1 - cluster_random(c)) * 3600e6 / c->spec->failures, e->node,
          0, fail_host);
}

/* Speeds from the slowest to the fastest, in no order, their mean 1. */
static void
make_hosts(struct cluster *c)
{
    const struct cluster_spec *s = c->spec;
    int n = s->hosts;

    c->hosts = sim_alloc((size_t)n * host_size());
    c->link = sim_alloc((size_t)n * sizeof *c->link);
    for (int i = 0; i < n; i++) {
        int rank = (int)((long)i * 7919 % n); /* a prime: a permutation */
        double t = n > 1 ? (double)rank / (n - 1) : .5;
        double speed = 1 + t * (s->uneven - 1);

        if (i == n - 1 && n > 1)
            speed /= s->slow;

        host_init(c, host_at(c, i), i, speed / ((1 + s->uneven) / 2));
        c->out->speed += s->threads * speed / ((1 + s->uneven) / 2);
    }
}

static void
begin_tiles(struct cluster *c)
{
    const struct tiles *t = c->spec->tiles;

    c->out->work += t->passes_s;
    for (uint32_t i = 0; i < t->npasses; i++)
        c->made[i] = sim_alloc(t->pass[i].n + 1);
}

static void
run_to_end(struct cluster *c)
{
    double most = STUCK * (c->out->work / c->out->speed * c->spec->hosts + 100);

    while (!c->over && events_step(&c->events, &c->now_us, c))
        if ((double)c->now_us > 1e6 * most) {
            snprintf(c->out->text, sizeof c->out->text, "stuck after %.0f s",
                     1e-6 * (double)c->now_us);
            return;
        }
}

void
cluster_run(const struct cluster_spec *s, struct cluster_result *out)
{
    struct cluster c = { .spec = s, .out = out, .job = { 7 } };
    struct coord_env env = { .has_file = has_file,
                             .random = cluster_bytes,
                             .arg = &c,
                             .program = "sim",
                             .epoch = 1 };

    memset(out, 0, sizeof *out);
    out->threads = s->hosts * s->threads;
    c.coord = coord_new(&env);
    make_hosts(&c);
    out->work = s->map->total * (1 + s->growth * log2(s->hosts));
    if (s->tiles)
        begin_tiles(&c);
    for (int i = 0; i < s->hosts; i++)
        host_start(&c, host_at(&c, i));
    say_hello(&c);
    tick(&c, NULL);
    later(&c, 100000, 0, 0, begin);
    for (int i = 0; s->failures > 0 && i < s->hosts; i++)
        later(&c, -log(1 - cluster_random(&c)) * 3600e6 / s->failures, i, 0,
              fail_host);
    run_to_end(&c);
    for (int i = 0; i < s->hosts; i++) {
        host_over(host_at(&c, i));
        host_count(host_at(&c, i), out);
        host_release(host_at(&c, i));
    }
    for (int i = 0; i < RAD_MOST_PASSES; i++)
        free(c.made[i]);
    free(c.hosts);
    free(c.link);
    coord_free(c.coord);
    events_release(&c.events);
    msg_release(&c.msg);
}
