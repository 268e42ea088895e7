/* check_strict.c - the strict units of a few children under many seeds
 *
 * A miniature cluster: each node is a struct strict whose passes run, one
 * inside another's callbacks, on the real sampler and an analytic picture; what
 * they send goes through a router that delays, reorders and repeats, to a
 * coordinator that hands out units, has them split and doubled, and loses
 * nodes.  Whatever happens, the picture and its primary rays are those of one
 * sampler alone.
 * RADD_STRICT_SEED=n replays one seed, RADD_STRICT_RUNS=n tries that many. */
#include "config.h"

#include "strict/strict_impl.h"
#include "proto/frame.h"
#include "unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RUNS     500
#define NODES    5
#define HOLDERS  3
#define LINES    80
#define UNITS    300
#define DEPTH    3 /* passes inside passes */
#define COORD    NODES
#define STEPS    20000
#define LINE_MSG 200 /* messages kept about a line */

static const uint8_t job_id[MSG_JOB] = { 7 };

/* What is under way: a packed message, or the rows of a unit. */
struct event {
    struct event *next;
    uint64_t at;
    int from, to, life; /* life of the node it goes to, or comes from */
    uint16_t type;      /* MSG_RESULT: the fields below */
    uint8_t *payload;
    size_t len;
    uint32_t unit, attempt;
    int row, rows;
    bool last;
    uint64_t primary, speculative;
    struct rad_pixel *pixels;
};

struct holder {
    int node; /* -1: none */
    uint32_t attempt;
    bool parked, resumed, top_sent;
    int rows; /* of the unit, that it sent */
};

struct unit {
    int first, last;
    bool done, splitting;
    uint32_t attempts;
    struct holder by[HOLDERS];
};

struct kept {
    uint8_t *payload;
    size_t len;
};

struct line {
    struct kept facts[LINE_MSG], base[LINE_MSG];
    int nfacts, nbase;
    size_t have;
    uint8_t *seen; /* columns, then densities */
};

struct world;

struct node {
    struct world *w;
    int id;
    bool up;
    int life, last_line;
    struct strict *s;
    struct run *runs; /* passes under way, the innermost first */
    uint64_t due;     /* when to look again if nothing happens */
};

/* A pass at work. */
struct run {
    struct run *outer;
    struct node *node;
    int life;
    struct strict_pass *pass;
    struct team *team;
    struct rad_pixel *rows;
    int first_row, nrows;
};

struct tally {
    uint64_t primary, speculative, late, traced, kills, splits, twins, parked,
        tops, aside;
};

struct world {
    uint64_t seed, random, now;
    struct rad_quincunx q;
    int nlines, nnodes, depth;
    size_t ndensity;
    struct rad_pixel *want, *got;
    uint64_t want_primary, primary, speculative;
    uint64_t late; /* facts of lines that were done */
    struct node node[NODES];
    struct unit unit[UNITS];
    int nunits, kills, splits, twins; /* the three: that may come yet */
    struct tally did;
    struct line line[LINES];
    struct event *events;
    uint64_t link_at[NODES + 1][NODES + 1]; /* when the last message arrives */
    bool paint, peers;
};

static uint64_t
mix(uint64_t x)
{
    x += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

static int
any(struct world *w, int n)
{
    return (int)(mix(w->random++) % (uint64_t)n);
}

static bool
chance(struct world *w, int percent)
{
    return any(w, 100) < percent;
}

/* --- the picture --- */

/* Edges, a ramp, stripes and a speckled patch; nothing in the corners. */
static bool
value(const struct world *w, int x, int y, struct rad_pixel *out)
{
    double u = (double)x / w->q.width, v = (double)y / w->q.height;
    double a = .2 + .1 * u + .05 * sin(9 * v);

    out->L = rad_grey(0);
    out->z = 0;
    if (u + v < .12 || u + v > 1.9)
        return false;
    if ((u - .4) * (u - .4) + (v - .5) * (v - .5) < .05)
        a = .8 + .3 * v;
    if (u > .7 && v < .4 && sin(60 * u + 10 * v) > 0)
        a = 1.3;
    if (u > .6 && v > .7)
        a *= 1 + .5 * (double)(mix((uint64_t)(x * 1000 + y)) % 100) / 100;
    out->L = rad_rgb((float)a, (float)(a * (1 - .3 * u)), (float)(.5 * a));
    if (w->q.depth)
        out->z = (float)(1 + a + u);
    return true;
}

/* Not the same when it is done twice. */
static void
paint_pixel(int x, int y, struct rad_pixel *p)
{
    if (mix((uint64_t)(x * 7919 + y)) % 37 == 0)
        p->L.g = p->L.g * .5F + 2;
}

static void
paint_row(const struct world *w, int x0, int x1, int y, struct rad_pixel *row)
{
    for (int x = x0; x < x1 && w->paint; x++)
        paint_pixel(x, y, &row[x - x0]);
}

static void
trace_alone(void *arg, int x, int y, struct rad_pixel *out)
{
    struct world *w = arg;

    w->want_primary += value(w, x, y, out);
}

static void
render_alone(struct world *w)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    size_t width = (size_t)w->q.width;
    uint8_t density[256];

    rad_quincunx_start(&w->q, density);
    for (int i = 0; i < w->nlines; i++) {
        int y = rad_quincunx_base_row(&w->q, i), top = y;

        rad_quincunx_base(&w->q, i, density, w->want + (size_t)y * width);
        if (i > 0) {
            top = rad_quincunx_base_row(&w->q, i - 1);
            for (int k = 0; k <= y - top; k++)
                rows[k] = w->want + (size_t)(top + k) * width;
            rad_quincunx_bar(&w->q, i - 1, rows);
            top++;
        }
        for (int k = top; k <= y; k++)
            paint_row(w, 0, w->q.width, k, w->want + (size_t)k * width);
    }
}

/* --- the router --- */

/* Facts may overtake others; the rest comes in order, as pieces of a base line
 * from one sender do, and a base line is with the coordinator before the rows
 * of its unit are. */
static void
post(struct world *w, struct event *e, bool in_order)
{
    uint64_t at = w->now + 1 + (uint64_t)any(w, chance(w, 10) ? 300 : 20);
    struct event **p = &w->events;

    if (in_order) {
        uint64_t *last = &w->link_at[e->from][e->to];

        if (at < *last)
            at = *last;
        *last = at;
    }
    e->at = at;
    while (*p && (*p)->at <= at)
        p = &(*p)->next;
    e->next = *p;
    *p = e;
}

static struct event *
event_new(struct world *w, int from, int to, uint16_t type)
{
    struct event *e = calloc(1, sizeof *e);

    ck_assert_ptr_nonnull(e);
    e->from = from;
    e->to = to;
    e->type = type;
    e->life = w->node[to == COORD ? from : to].life;
    return e;
}

static void
post_bytes(struct world *w, int from, int to, uint16_t type,
           const uint8_t *payload, size_t len)
{
    bool pure = type == MSG_FACTS || type == MSG_BASE_LINE;
    int copies = pure && chance(w, 5) ? 2 : 1;

    while (copies-- > 0) {
        struct event *e = event_new(w, from, to, type);

        e->payload = malloc(len + 1);
        ck_assert_ptr_nonnull(e->payload);
        memcpy(e->payload, payload, len);
        e->len = len;
        post(w, e, type != MSG_FACTS);
    }
}

static void
post_msg(struct world *w, int from, int to, const struct msg *m)
{
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&out, m), 0);
    post_bytes(w, from, to, m->type, out.buf + MSG_HEADER,
               out.len - MSG_HEADER);
    wire_out_release(&out);
}

static void
event_free(struct event *e)
{
    free(e->payload);
    free(e->pixels);
    free(e);
}

/* --- the coordinator --- */

static struct unit *
unit_of_line(struct world *w, int line)
{
    for (int i = 0; i < w->nunits; i++)
        if (line >= w->unit[i].first && line < w->unit[i].last)
            return &w->unit[i];
    ck_abort_msg("seed %llu: line %d is nobody's", (unsigned long long)w->seed,
                 line);
}

static struct holder *
holder_of(struct unit *u, int node)
{
    for (int k = 0; k < HOLDERS; k++)
        if (u->by[k].node == node)
            return &u->by[k];
    return NULL;
}

static int
nholders(const struct unit *u)
{
    int n = 0;

    for (int k = 0; k < HOLDERS; k++)
        n += u->by[k].node >= 0;
    return n;
}

static void
send_attempt(struct world *w, struct unit *u, const struct holder *h,
             uint16_t type)
{
    struct msg m = { .type = type };

    m.revoke =
        (struct msg_attempt){ job_id, (uint32_t)(u - w->unit), h->attempt };
    post_msg(w, COORD, h->node, &m);
}

static void
keep(struct world *w, struct kept *list, int *n, const struct event *e)
{
    ck_assert_msg(*n < LINE_MSG, "seed %llu: too many messages about a line",
                  (unsigned long long)w->seed);
    list[*n].payload = malloc(e->len + 1);
    memcpy(list[*n].payload, e->payload, e->len);
    list[(*n)++].len = e->len;
}

static bool
line_whole(const struct world *w, int line)
{
    return w->line[line].have == (size_t)w->q.width + w->ndensity;
}

static void
send_top(struct world *w, const struct unit *u, struct holder *h)
{
    const struct line *l = &w->line[u->first - 1];

    h->top_sent = true;
    for (int i = 0; i < l->nbase; i++)
        post_bytes(w, COORD, h->node, MSG_BASE_LINE, l->base[i].payload,
                   l->base[i].len);
}

static void
hand_out(struct world *w, struct unit *u, int node)
{
    struct holder *h = holder_of(u, -1);
    bool twin = nholders(u) > 0, top = false;
    int y = team_line_row(&w->q, u->first);
    int end = u->last < w->nlines ? team_line_row(&w->q, u->last) : w->q.height;
    struct msg m = { .type = MSG_UNIT };

    *h = (struct holder){ .node = node, .attempt = ++u->attempts };
    if (u->first > 0) {
        struct unit *a = unit_of_line(w, u->first - 1);

        top = !a->done && nholders(a) == 0;
        w->did.tops += top;
    }
    m.unit = (struct msg_unit){ .job = job_id,
                                .unit = (uint32_t)(u - w->unit),
                                .attempt = h->attempt,
                                .y = (uint32_t)y,
                                .width = (uint32_t)w->q.width,
                                .height = (uint32_t)(end - y),
                                .mode = MSG_MODE_STRICT,
                                .end = (uint8_t)(twin ? h - u->by : 0) };
    m.unit.flags = (top ? MSG_UNIT_TOP : 0) | (twin ? MSG_UNIT_TWIN : 0) |
                   (chance(w, 50) ? MSG_UNIT_BARS : 0);
    w->node[node].last_line = u->last;
    for (int i = u->first > 0 ? u->first - 1 : 0; i < u->last; i++)
        for (int k = 0; k < w->line[i].nfacts; k++)
            post_bytes(w, COORD, node, MSG_FACTS, w->line[i].facts[k].payload,
                       w->line[i].facts[k].len);
    if (u->first > 0)
        send_top(w, u, h);
    h->top_sent = u->first == 0 || line_whole(w, u->first - 1);
    post_msg(w, COORD, node, &m);
    for (int k = 0; k < HOLDERS && twin; k++)
        if (u->by[k].node >= 0 && &u->by[k] != h)
            send_attempt(w, u, &u->by[k], MSG_TWIN);
}

static void
take_result(struct world *w, const struct event *e)
{
    struct unit *u = &w->unit[e->unit];
    struct holder *h = holder_of(u, e->from);
    size_t width = (size_t)w->q.width;

    if (!h || h->attempt != e->attempt || u->done)
        return;
    ck_assert_int_eq(e->row, team_line_row(&w->q, u->first) + h->rows);
    h->rows += e->rows;
    ck_assert((e->row + e->rows ==
               rad_quincunx_base_row(&w->q, u->last - 1) + 1) == e->last);
    memcpy(w->got + (size_t)e->row * width, e->pixels,
           (size_t)e->rows * width * sizeof *e->pixels);
    if (!e->last) {
        w->did.aside++;
        return;
    }
    w->primary += e->primary;
    w->speculative += e->speculative;
    u->done = true;
    for (int k = 0; k < HOLDERS; k++) {
        if (u->by[k].node >= 0 && &u->by[k] != h)
            send_attempt(w, u, &u->by[k], MSG_REVOKE);
        u->by[k].node = -1;
    }
}

static void
take_facts(struct world *w, const struct event *e, const struct msg_facts *m)
{
    struct unit *u = unit_of_line(w, (int)m->line);
    struct line *l = &w->line[m->line];

    if (u->done) {
        w->late += m->npixels;
        return;
    }
    keep(w, l->facts, &l->nfacts, e);
    for (int k = 0; k < HOLDERS; k++)
        if (u->by[k].node >= 0 && u->by[k].node != e->from && chance(w, 97))
            post_bytes(w, COORD, u->by[k].node, MSG_FACTS, e->payload, e->len);
}

static void
take_base_line(struct world *w, const struct event *e,
               const struct msg_base_line *m)
{
    struct line *l = &w->line[m->line];
    struct unit *u = unit_of_line(w, (int)m->line + 1);

    keep(w, l->base, &l->nbase, e);
    for (size_t i = 0; i < m->n; i++)
        l->have += !l->seen[m->x + i], l->seen[m->x + i] = 1;
    for (size_t i = 0; i < m->ndensity; i++) {
        uint8_t *seen = &l->seen[(size_t)w->q.width + m->first + i];

        l->have += !*seen;
        *seen = 1;
    }
    for (int k = 0; k < HOLDERS && line_whole(w, (int)m->line); k++)
        if (u->first == (int)m->line + 1 && u->by[k].node >= 0 &&
            u->by[k].parked && !u->by[k].top_sent)
            send_top(w, u, &u->by[k]);
}

static struct unit *
unit_and_holder(struct world *w, const struct event *e,
                const struct msg_attempt *m, struct holder **h)
{
    struct unit *u = &w->unit[m->unit];

    *h = holder_of(u, e->from);
    return *h && (*h)->attempt == m->attempt && !u->done ? u : NULL;
}

static void
take_parked(struct world *w, const struct event *e, const struct msg_attempt *m)
{
    struct holder *h;
    struct unit *u = unit_and_holder(w, e, m, &h);

    if (!u)
        return;
    ck_assert(!h->parked || h->resumed);
    h->parked = true;
    h->resumed = false;
    w->did.parked++;
    if (u->first > 0 && line_whole(w, u->first - 1) && !h->top_sent)
        send_top(w, u, h);
}

static void
take_resumed(struct world *w, const struct event *e,
             const struct msg_attempt *m)
{
    struct holder *h;

    if (!unit_and_holder(w, e, m, &h))
        return;
    ck_assert(h->parked && !h->resumed);
    h->resumed = true;
}

static void
take_gave(struct world *w, const struct event *e, const struct msg_gave *m)
{
    struct msg_attempt a = { m->job, m->unit, m->attempt };
    struct holder *h;
    struct unit *u = unit_and_holder(w, e, &a, &h), *lower;
    int last;

    if (!u)
        return;
    ck_assert(u->splitting);
    u->splitting = false;
    last = u->first;
    while (last < u->last &&
           team_line_row(&w->q, last) <
               team_line_row(&w->q, u->first) + (int)m->height)
        last++;
    ck_assert_int_gt(last, u->first);
    if (last == u->last)
        return;
    w->did.splits++;
    ck_assert_int_lt(w->nunits, UNITS);
    lower = &w->unit[w->nunits++];
    *lower = (struct unit){ .first = last, .last = u->last };
    for (int k = 0; k < HOLDERS; k++)
        lower->by[k].node = -1;
    u->last = last;
}

static void
lose_node(struct world *w, int n)
{
    struct node *d = &w->node[n];

    w->did.kills++;
    d->up = false;
    d->life++;
    for (struct run *r = d->runs; r; r = r->outer)
        team_stop(r->team);
    for (int i = 0; i < w->nunits; i++) {
        struct holder *h = holder_of(&w->unit[i], n);

        if (h) {
            h->node = -1;
            w->unit[i].splitting = false;
        }
    }
}

/* --- a node --- */

/* Send what a node has to say: its base lines to who needs them, too. */
static void
speak(struct node *d)
{
    struct world *w = d->w;
    const struct msg *m;

    while ((m = strict_message(d->s, chance(w, 70)))) {
        post_msg(w, d->id, COORD, m);
        if (m->type != MSG_BASE_LINE || !w->peers || chance(w, 5))
            continue;
        for (int k = 0; k < HOLDERS; k++) {
            struct unit *u = unit_of_line(w, (int)m->base_line.line + 1);
            int to = u->by[k].node;

            if (to >= 0 && to != d->id)
                post_msg(w, d->id, to, m);
        }
    }
    ck_assert_int_eq(strict_error(d->s), 0);
}

/* What a loop does when it wakes: look at the passes under way. */
static void
look(struct node *d)
{
    for (struct run *r = d->runs; r; r = r->outer)
        if (r->life == d->life)
            strict_look(d->s, r->pass, r->team);
    d->due = strict_tick(d->s, d->w->now);
    speak(d);
}

static void
deliver_to_node(struct node *d, const struct msg *m)
{
    struct rad_error err = { 0 };

    switch (m->type) {
    case MSG_UNIT:
        ck_assert_int_eq(strict_unit(d->s, &m->unit, &err), 0);
        break;
    case MSG_REVOKE:
        strict_revoke(d->s, m->revoke.unit, m->revoke.attempt);
        break;
    case MSG_SPLIT:
        strict_split(d->s, m->split.unit, m->split.attempt);
        break;
    case MSG_TWIN:
        strict_twin(d->s, m->twin.unit, m->twin.attempt);
        break;
    case MSG_FACTS:
        strict_facts(d->s, &m->facts);
        break;
    case MSG_BASE_LINE:
        strict_base_line(d->s, &m->base_line);
        break;
    default:
        ck_abort_msg("message %s", msg_name(m->type));
    }
    look(d);
}

static void
deliver_to_coord(struct world *w, const struct event *e, const struct msg *m)
{
    switch (m->type) {
    case MSG_FACTS:
        take_facts(w, e, &m->facts);
        break;
    case MSG_BASE_LINE:
        take_base_line(w, e, &m->base_line);
        break;
    case MSG_PARKED:
        take_parked(w, e, &m->parked);
        break;
    case MSG_GAVE:
        take_gave(w, e, &m->gave);
        break;
    case MSG_RESUMED:
        take_resumed(w, e, &m->resumed);
        break;
    case MSG_LINE_COSTS:
        break; /* no thread runs here */
    default:
        ck_abort_msg("message %s", msg_name(m->type));
    }
}

/* The next message arrives. */
static void
deliver(struct world *w)
{
    struct event *e = w->events;
    struct node *d;
    struct msg m = { 0 };

    if (!e)
        return;
    w->events = e->next;
    if (e->at > w->now)
        w->now = e->at;
    d = &w->node[e->to == COORD ? e->from : e->to];
    if (d->up && d->life == e->life) {
        if (e->type == MSG_RESULT) {
            take_result(w, e);
        } else {
            ck_assert_int_eq(
                msg_unpack(&m, e->type, 0, e->payload, e->len, NULL), 0);
            if (e->to == COORD)
                deliver_to_coord(w, e, &m);
            else
                deliver_to_node(d, &m);
            msg_release(&m);
        }
    }
    event_free(e);
}

static void run_pass(struct node *d);

/* Other things go on while a pixel is traced. */
static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct run *r = arg;
    struct world *w = r->node->w;

    (void)ctx;
    if (chance(w, 4)) {
        int n = any(w, w->nnodes);

        if (w->events && chance(w, 80))
            deliver(w);
        else if (w->depth < DEPTH && w->node[n].up)
            run_pass(&w->node[n]);
        if (r->node->up && r->life == r->node->life && chance(w, 20))
            look(r->node);
    }
    if (!value(w, x, y, out))
        return false;
    w->did.traced++;
    return true;
}

static void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct run *r = arg;

    (void)ctx;
    paint_row(r->node->w, x0, x1, y, row);
}

static void
take_row(void *arg, int row, const struct rad_pixel *pixels)
{
    struct run *r = arg;
    size_t width = (size_t)r->node->w->q.width;

    if (r->nrows == 0)
        r->first_row = row;
    ck_assert_int_eq(row, r->first_row + r->nrows);
    memcpy(r->rows + (size_t)r->nrows++ * width, pixels,
           width * sizeof *pixels);
}

/* Rows of a pass; total: the unit is done with them. */
static void
send_result(struct run *r, uint32_t unit, uint32_t attempt,
            const struct msg_counts *total)
{
    struct world *w = r->node->w;
    struct event *e = event_new(w, r->node->id, COORD, MSG_RESULT);

    e->unit = unit;
    e->attempt = attempt;
    e->row = r->first_row;
    e->rows = r->nrows;
    e->last = total;
    e->primary = total ? total->primary_rays : 0;
    e->speculative = total ? total->speculative_rays : 0;
    e->pixels = r->rows;
    r->rows = NULL;
    post(w, e, true);
}

/* The team has left. */
static void
end_pass(struct run *r)
{
    struct node *d = r->node;
    struct team_bottom b = { 0 };
    uint32_t unit = r->pass->unit, attempt = r->pass->attempt;
    struct msg_counts spent = { .rays = team_rays(r->team) }, total;
    bool over;

    if (r->pass->mode == TEAM_TRUTH)
        spent.primary_rays = team_primary(r->team);
    team_bottom(r->team, &b);
    team_blocked(r->team, &r->pass->finished);
    over = strict_ended(d->s, r->pass, team_done(r->team), b.pixels, b.density,
                        &spent, &total);
    speak(d);
    if (over || r->nrows > 0)
        send_result(r, unit, attempt, over ? &total : NULL);
}

static void
run_pass(struct node *d)
{
    struct world *w = d->w;
    struct run r = { .outer = d->runs, .node = d, .life = d->life };
    struct strict *s = d->s;
    struct team_spec spec = { .sampler = w->q,
                              .trace = trace,
                              .paint = paint,
                              .arg = &r,
                              .nthreads = 1 };

    r.pass = strict_next(s, STRICT_AHEAD);
    if (!r.pass)
        return;
    strict_describe(r.pass, &spec);
    if (spec.mode == TEAM_TRUTH)
        spec.truth.rows = take_row;
    r.team = team_new(&spec);
    r.rows = calloc((size_t)w->q.width * (size_t)w->q.height, sizeof *r.rows);
    ck_assert(r.team && r.rows);
    d->runs = &r;
    d->due = 0; /* its loop is told of a pass */
    w->depth++;
    team_work(r.team, NULL);
    w->depth--;
    d->runs = r.outer;
    if (r.life == d->life) {
        end_pass(&r);
    } else {
        struct msg_counts none = { 0 };

        strict_ended(s, r.pass, false, NULL, NULL, &none, NULL);
        if (!d->runs)
            d->up = false;
    }
    team_free(r.team);
    free(r.rows);
}

/* --- what happens --- */

static int
load(const struct world *w, int node)
{
    int n = 0;

    for (int i = 0; i < w->nunits; i++)
        for (int k = 0; k < HOLDERS; k++)
            n += w->unit[i].by[k].node == node && !w->unit[i].by[k].parked;
    return n;
}

/* A unit that nobody has for a node that has room. */
static void
give_work(struct world *w)
{
    int node = any(w, w->nnodes), free[UNITS], n = 0, best = -1;

    if (!w->node[node].up || load(w, node) >= 2)
        return;
    for (int i = 0; i < w->nunits; i++)
        if (!w->unit[i].done && nholders(&w->unit[i]) == 0) {
            free[n++] = i;
            if (w->unit[i].first == w->node[node].last_line)
                best = i;
        }
    if (n == 0)
        return;
    if (best < 0 || chance(w, 30))
        best = free[any(w, n)];
    hand_out(w, &w->unit[best], node);
}

static void
disturb(struct world *w)
{
    struct unit *u = &w->unit[any(w, w->nunits)];
    int n = nholders(u), node = any(w, w->nnodes), k = any(w, HOLDERS);

    if (w->kills > 0 && chance(w, 10) && w->node[node].up) {
        w->kills--;
        lose_node(w, node);
        return;
    }
    if (u->done || n == 0)
        return;
    if (w->splits > 0 && n == 1 && !u->splitting && u->last - u->first > 1 &&
        u->by[k].node >= 0) {
        w->splits--;
        u->splitting = true;
        send_attempt(w, u, &u->by[k], MSG_SPLIT);
    } else if (w->twins > 0 && n < HOLDERS && !u->splitting &&
               !holder_of(u, node) && w->node[node].up && load(w, node) < 2) {
        w->twins--;
        w->did.twins++;
        hand_out(w, u, node);
    }
}

/* A node that was lost comes back, with nothing. */
static void
revive(struct world *w)
{
    for (int n = 0; n < w->nnodes; n++) {
        struct node *d = &w->node[n];

        if (d->up || d->runs || !chance(w, 20))
            continue;
        strict_free(d->s);
        d->s = strict_new(&w->q, 1, w->paint, job_id);
        d->last_line = -1;
        d->due = 0;
        d->up = true;
    }
}

static void
step(struct world *w)
{
    int node = any(w, w->nnodes);

    switch (any(w, 6)) {
    case 0:
        give_work(w);
        break;
    case 1:
    case 2:
        deliver(w);
        break;
    case 3:
        if (w->node[node].up)
            run_pass(&w->node[node]);
        break;
    case 4:
        disturb(w);
        revive(w);
        break;
    default:
        w->now += (uint64_t)any(w, 20);
        if (w->node[node].up && w->now >= w->node[node].due)
            look(&w->node[node]);
    }
}

static bool
all_done(const struct world *w)
{
    for (int i = 0; i < w->nunits; i++)
        if (!w->unit[i].done)
            return false;
    return true;
}

/* --- a run --- */

static void
set_units(struct world *w)
{
    int most = chance(w, 30) ? 1 : 1 + any(w, w->nlines);

    for (int i = 0; i < w->nlines;) {
        struct unit *u = &w->unit[w->nunits++];

        u->first = i;
        i += 1 + any(w, most) + (i == 0 && chance(w, 80));
        u->last = i = i < w->nlines ? i : w->nlines;
        for (int k = 0; k < HOLDERS; k++)
            u->by[k].node = -1;
    }
}

static void
set_up(struct world *w, uint64_t seed)
{
    size_t n;

    memset(w, 0, sizeof *w);
    w->seed = seed;
    w->random = mix(seed);
    rad_quincunx_steps(chance(w, 60) ? 4 : 1 + any(w, 9), &w->q.xstep,
                       &w->q.ystep);
    w->q.width = 20 + any(w, 100);
    w->q.height = 10 + any(w, 70);
    w->q.maxdiff = chance(w, 50) ? .05 : .3 * any(w, 100) / 100;
    w->q.depth = chance(w, 25);
    w->paint = chance(w, 50);
    w->peers = chance(w, 80);
    w->nlines = rad_quincunx_nbases(&w->q);
    w->ndensity = rad_quincunx_ndensity(&w->q);
    w->nnodes = 1 + any(w, NODES);
    w->kills = chance(w, 50) ? any(w, 4) : 0;
    w->splits = chance(w, 60) ? any(w, 20) : 0;
    w->twins = chance(w, 40) ? any(w, 6) : 0;
    n = (size_t)w->q.width * (size_t)w->q.height;
    w->want = calloc(n, sizeof *w->want);
    w->got = calloc(n, sizeof *w->got);
    for (int i = 0; i < w->nlines; i++)
        w->line[i].seen = calloc((size_t)w->q.width + w->ndensity, 1);
    for (int i = 0; i < w->nnodes; i++)
        w->node[i] =
            (struct node){ .w = w,
                           .id = i,
                           .up = true,
                           .last_line = -1,
                           .s = strict_new(&w->q, 1, w->paint, job_id) };
    w->q.trace = trace_alone;
    w->q.arg = w;
    render_alone(w);
    set_units(w);
}

static void
tear_down(struct world *w)
{
    while (w->events) {
        struct event *e = w->events;

        w->events = e->next;
        event_free(e);
    }
    for (int i = 0; i < w->nlines; i++) {
        struct line *l = &w->line[i];

        while (l->nfacts > 0)
            free(l->facts[--l->nfacts].payload);
        while (l->nbase > 0)
            free(l->base[--l->nbase].payload);
        free(l->seen);
    }
    for (int i = 0; i < w->nnodes; i++)
        strict_free(w->node[i].s);
    free(w->want);
    free(w->got);
}

static void
check_picture(const struct world *w)
{
    for (int y = 0; y < w->q.height; y++)
        for (int x = 0; x < w->q.width; x++) {
            size_t i = (size_t)y * (size_t)w->q.width + (size_t)x;

            ck_assert_msg(memcmp(&w->want[i], &w->got[i], sizeof *w->got) == 0,
                          "seed %llu: pixel %d %d is another",
                          (unsigned long long)w->seed, x, y);
        }
    ck_assert_msg(w->primary == w->want_primary,
                  "seed %llu: %llu primary rays, not %llu",
                  (unsigned long long)w->seed, (unsigned long long)w->primary,
                  (unsigned long long)w->want_primary);
}

static void
run(uint64_t seed, struct world *w)
{
    set_up(w, seed);
    for (int i = 0; i < STEPS && !all_done(w); i++)
        step(w);
    ck_assert_msg(all_done(w), "seed %llu: it does not end",
                  (unsigned long long)seed);
    check_picture(w);
    tear_down(w);
}

static void
add(struct tally *sum, const struct world *w)
{
    sum->primary += w->primary;
    sum->speculative += w->speculative;
    sum->late += w->late;
    sum->traced += w->did.traced;
    sum->kills += w->did.kills;
    sum->splits += w->did.splits;
    sum->twins += w->did.twins;
    sum->parked += w->did.parked;
    sum->tops += w->did.tops;
    sum->aside += w->did.aside;
}

static double
percent(uint64_t a, uint64_t b)
{
    return 100. * (double)a / (double)b;
}

static uint64_t
number(const char *name, uint64_t otherwise)
{
    const char *text = getenv(name);

    return text ? strtoull(text, NULL, 10) : otherwise;
}

START_TEST(any_cluster_makes_the_picture_and_rays_of_one_sampler)
{
    static struct world w;
    uint64_t seed = number("RADD_STRICT_SEED", 1);
    uint64_t runs =
        number("RADD_STRICT_RUNS", getenv("RADD_STRICT_SEED") ? 1 : RUNS);
    struct tally did = { 0 };

    for (uint64_t i = 0; i < runs; i++) {
        run(seed + i, &w);
        add(&did, &w);
    }
    printf("%llu runs: %llu primary rays, for nothing %.2f %%, late %.2f %%, "
           "all traced %.2f %%; %llu nodes lost, %llu splits, %llu twins, "
           "%llu parked, %llu tops made, %llu times rows in two goes\n",
           (unsigned long long)runs, (unsigned long long)did.primary,
           percent(did.speculative, did.primary),
           percent(did.late, did.primary), percent(did.traced, did.primary),
           (unsigned long long)did.kills, (unsigned long long)did.splits,
           (unsigned long long)did.twins, (unsigned long long)did.parked,
           (unsigned long long)did.tops, (unsigned long long)did.aside);
    ck_assert(did.speculative * 50 < did.primary);
    if (runs < RUNS)
        return;
    ck_assert(did.kills && did.splits && did.twins && did.parked && did.tops &&
              did.aside);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("strict");
    TCase *tc = tcase_create("strict");

    tcase_add_test(tc, any_cluster_makes_the_picture_and_rays_of_one_sampler);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
