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

/* Facts and base lines may overtake others; the rest comes in order, and a base
 * line is with the coordinator before the rows of its unit are. */
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
        post(w, e, !pure || (type == MSG_BASE_LINE && to == COORD));
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
        spec.rows = take_row;
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

/* The next pass must be of that rank; it ends at once, done. */
static void
expect_pass(struct strict *s, enum strict_rank rank, bool last)
{
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p = strict_next(s, STRICT_AHEAD);

    ck_assert_ptr_nonnull(p);
    ck_assert_int_eq(p->rank, rank);
    ck_assert(strict_ended(s, p, true, bottom, density, &spent, &total) ==
              last);
}

static struct rad_quincunx
sampler(int width, int height)
{
    struct rad_quincunx q = { .width = width, .height = height };

    rad_quincunx_steps(4, &q.xstep, &q.ystep);
    return q;
}

/* A block of line 4 of a picture of 64 columns, black. */
static struct msg_loan
some_loan(void)
{
    static const uint8_t bytes[64 * 12];

    return (struct msg_loan){ .job = job_id,
                              .unit = 3,
                              .attempt = 9,
                              .line = 4,
                              .x = 6,
                              .n = 6,
                              .channels = 3,
                              .wanted = bytes,
                              .top = bytes,
                              .bottom = bytes };
}

/* The whole top of line 4 of a picture of 64 columns, black. */
static void
give_top_of(struct strict *s, const struct rad_quincunx *q, uint32_t frame)
{
    static const uint8_t pixels[64 * 12], density[64];
    const struct msg_base_line top = { .job = job_id,
                                       .frame = frame,
                                       .line = 3,
                                       .n = 64,
                                       .ndensity =
                                           (uint32_t)rad_quincunx_ndensity(q),
                                       .channels = 3,
                                       .density = density,
                                       .pixels = pixels };

    strict_base_line(s, &top);
}

static void
give_top(struct strict *s, const struct rad_quincunx *q)
{
    give_top_of(s, q, 0);
}

static void
give_flagged(struct strict *s, const struct rad_quincunx *q, uint32_t number,
             int first, int last, uint8_t flags)
{
    uint32_t y = (uint32_t)team_line_row(q, first);
    const struct msg_unit u = { .job = job_id,
                                .unit = number,
                                .attempt = 1,
                                .y = y,
                                .width = 64,
                                .height = (uint32_t)team_line_row(q, last) - y,
                                .mode = MSG_MODE_STRICT,
                                .flags = flags };

    ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
}

static void
give_unit(struct strict *s, const struct rad_quincunx *q, uint32_t number,
          int first, int last)
{
    give_flagged(s, q, number, first, last, 0);
}

/* Whoever made it is wrong, not the job; its columns go back. */
START_TEST(a_loan_that_fits_no_line_is_not_taken)
{
    struct rad_quincunx q = sampler(64, 60);
    struct msg_loan loan = some_loan();
    struct rad_error err = { 0 };
    const struct msg *m;
    struct strict *s;

    loan.n = 5; /* no whole block */
    s = strict_new(&q, 1, false, job_id);
    ck_assert_int_eq(strict_loan(s, &loan, &err), RAD_EPROTO);
    ck_assert_ptr_nonnull(strstr(err.what, "unit 3"));
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_PAID);
    ck_assert(m->paid.unit == 3 && m->paid.attempt == 9);
    ck_assert_uint_eq(m->paid.counts.rays, 0);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    loan.n = 6;
    ck_assert_int_eq(strict_loan(s, &loan, &err), 0);
    expect_pass(s, STRICT_LOAN, false);
    strict_free(s);
}
END_TEST

/* Of a loan that cost 7 ns, and then of a unit whose second half was given
 * away: what was spent on it before stays with the lines. */
START_TEST(what_lines_cost_is_told)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_loan loan = some_loan();
    const struct msg_counts spent = { .rays = 2 };
    struct msg_counts total;
    struct strict_pass *p;
    const struct msg *m;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    ck_assert_int_eq(strict_loan(s, &loan, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_LOAN && p->first == 4);
    p->cpu_ns[0] = 7;
    strict_ended(s, p, true, NULL, NULL, &spent, &total);
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_LINE_COSTS);
    ck_assert(m->line_costs.frame == 0 && m->line_costs.line == 3);
    ck_assert_uint_eq(m->line_costs.nlines, 2);
    ck_assert(m->line_costs.cpu_ns[0] == 0 && m->line_costs.cpu_ns[1] == 7);
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_PAID);

    give_unit(s, &q, 1, 0, 4);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_TRUE_LINES && p->first == 0);
    for (unsigned i = 0; i < 4; i++)
        p->cpu_ns[i] = i + 1;
    strict_split(s, 1, 1);
    strict_shrunk(s, p, 2);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    while ((m = strict_message(s, true)) && m->type != MSG_LINE_COSTS)
        ;
    ck_assert_ptr_nonnull(m);
    ck_assert(m->line_costs.line == 0 && m->line_costs.nlines == 4);
    for (unsigned i = 0; i < 4; i++)
        ck_assert_uint_eq(m->line_costs.cpu_ns[i], i + 1);
    strict_free(s);
}
END_TEST

/* A pixel of a loan that its lender needed as well, and told of just then. */
START_TEST(what_a_loan_traced_for_nothing_is_told)
{
    static const struct rad_pixel pixel;
    struct rad_quincunx q = sampler(64, 60);
    struct msg_loan loan = some_loan();
    const struct msg_counts spent = { .rays = 2 };
    struct msg_counts total;
    struct rad_facts *facts;
    struct strict_pass *p;
    const struct msg *m;
    struct strict *s;

    loan.density = loan.top;
    s = strict_new(&q, 1, false, job_id);
    ck_assert_int_eq(strict_loan(s, &loan, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_LOAN);
    facts = p->facts[4];
    ck_assert(rad_facts_put(facts, 6, 0, &pixel, RAD_FACT_FOREIGN));
    ck_assert(!rad_facts_put(facts, 6, 0, &pixel, 0));
    ck_assert(rad_facts_put(facts, 7, 0, &pixel, 0));
    strict_ended(s, p, true, NULL, NULL, &spent, &total);
    while ((m = strict_message(s, true)) && m->type != MSG_PAID)
        ck_assert(m->type == MSG_FACTS || m->type == MSG_LINE_COSTS);
    ck_assert_ptr_nonnull(m);
    ck_assert_uint_eq(m->paid.counts.rays, 2);
    ck_assert_uint_eq(m->paid.counts.speculative_rays, 1);
    strict_free(s);
}
END_TEST

/* Having lent it would go over all of its lines again, through their facts. */
START_TEST(what_keeps_no_facts_does_not_lend)
{
    const struct msg_lend lend = { .job = job_id, .attempt = 1, .part = 99 };
    const struct msg_counts none = { 0 };
    struct rad_quincunx q = sampler(64, 61);
    int nlines;

    nlines = rad_quincunx_nbases(&q);
    for (int last = nlines - 1; last <= nlines; last++) {
        struct strict *s = strict_new(&q, 1, false, job_id);
        struct strict_pass *p;
        struct msg_counts total;

        give_unit(s, &q, 0, 0, last);
        if (last < nlines)
            expect_pass(s, STRICT_TRUE_LINES, false);
        p = strict_next(s, STRICT_TRUTH);
        ck_assert(p && p->rank == STRICT_TRUTH);
        strict_twin(s, 0, 1); /* too late for a whole frame */
        strict_lend(s, &lend);
        ck_assert_int_eq(p->lend > 0, last < nlines);
        strict_ended(s, p, false, NULL, NULL, &none, &total);
        p = strict_next(s, STRICT_TRUTH); /* it is made again, and kept */
        ck_assert(p && p->lend > 0);
        strict_ended(s, p, false, NULL, NULL, &none, &total);
        strict_free(s);
    }
}
END_TEST

/* Having lent columns of its last line, a unit has handed on all rows above;
 * without that line it would have none left to be its last. */
START_TEST(a_line_is_left_when_others_are_out)
{
    const struct msg_lend lend = { .job = job_id, .attempt = 1, .part = 99 };
    const struct msg_counts none = { 0 };
    struct rad_quincunx q = sampler(64, 60);
    uint8_t wanted[8] = { 0 };
    struct rad_pixel top[64] = { 0 };
    const struct team_loan loan = {
        .line = 6, .x = 6, .n = 6, .wanted = wanted, .top = top, .bottom = top
    };
    struct msg_back back = { .job = job_id, .attempt = 1, .line = 6 };
    struct msg_counts total;
    const struct msg *m;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 7);
    give_top(s, &q);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_TRUTH);
    ck_assert(p && p->rank == STRICT_TRUTH);
    ck_assert_int_eq(strict_least(p), 5);
    strict_lend(s, &lend);
    strict_lent(s, p, &loan);
    strict_blocked(s, p, 6);
    strict_ended(s, p, false, NULL, NULL, &none, &total);
    strict_back(s, &back);
    while (strict_message(s, true))
        ;
    strict_split(s, 0, 1);
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_GAVE);
    ck_assert_uint_eq(m->gave.height,
                      (uint32_t)(team_line_row(&q, 7) - team_line_row(&q, 4)));
    p = strict_next(s, STRICT_TRUTH);
    ck_assert(p && p->out == 6);
    ck_assert_int_eq(strict_least(p), 7);
    strict_ended(s, p, false, NULL, NULL, &none, &total);
    strict_free(s);
}
END_TEST

/* Of a unit whose top came late: AHEAD left its first bar out, for lack of
 * colours above, and nobody below should wait for that. */
START_TEST(a_late_top_lets_the_bottom_go_before_the_first_bar)
{
    struct rad_quincunx q = sampler(64, 60);
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 8);
    expect_pass(s, STRICT_LINES, false);
    expect_pass(s, STRICT_AHEAD, false);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_top(s, &q);
    expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* A unit that has time: its bars come along, are no longer given away once they
 * are made, and what is known of its densities is held against the truth. */
START_TEST(bars_that_come_along_stay)
{
    struct rad_quincunx q = sampler(64, 90);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_flagged(s, &q, 0, 4, 24, MSG_UNIT_BARS);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_LINES && p->filled == 24 && !p->earlier);
    strict_split(s, 0, 1);
    ck_assert(p->stop);
    p->finished = 12;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    p = strict_next(s, STRICT_AHEAD); /* of 12 lines that are left 6 are */
    ck_assert(p->last == 18 && p->filled == 18);
    p->finished = 18;
    strict_ended(s, p, true, NULL, NULL, &spent, &total);
    give_top(s, &q);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUE_LINES && p->filled == 4 && p->earlier);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* The top of a unit that has time comes while its last line is made: the pass
 * that leaves out lines that come out as they were has not the colours that a
 * bar below them is filled from. */
START_TEST(what_leaves_lines_out_fills_no_bars)
{
    struct rad_quincunx q = sampler(64, 90);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_flagged(s, &q, 0, 4, 24, MSG_UNIT_BARS);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_LINES && p->filled == 24);
    give_top(s, &q);
    ck_assert(p->stop);
    p->finished = 23;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUE_LINES && p->earlier);
    ck_assert_int_eq(p->filled, p->first);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* Line number of the next base line that is told of; -1: there is none. */
static int
next_base_line(struct strict *s)
{
    const struct msg *m;

    while ((m = strict_message(s, true)))
        if (m->type == MSG_BASE_LINE)
            return (int)m->base_line.line;
    return -1;
}

static const struct {
    bool painted;
    uint8_t density; /* after the first unit, which is guessed to be 0 */
    bool holds;
} guesses[] = {
    { false, 0, true },
    { false, 1, false },
    { true, 0, false },
};

/* Of two units that were traced ahead, the lower one from the upper one's
 * bottom: if that was right, so is its own, and nobody need wait for a pass. */
START_TEST(a_guess_from_true_densities_is_true)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    uint8_t density[64] = { guesses[_i].density };
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, guesses[_i].painted, job_id);
    give_unit(s, &q, 0, 4, 8);
    give_unit(s, &q, 1, 8, 11);
    for (int i = 0; i < 2; i++)
        expect_pass(s, STRICT_LINES, false);
    for (int i = 0; i < 2; i++)
        expect_pass(s, STRICT_AHEAD, false);
    ck_assert_int_eq(next_base_line(s), -1);
    give_top(s, &q);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUE_LINES);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    if (guesses[_i].holds)
        ck_assert_int_eq(next_base_line(s), 10);
    ck_assert_int_eq(next_base_line(s), 7);
    ck_assert_int_eq(next_base_line(s), -1);
    if (!guesses[_i].holds)
        expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* A line goes out as fast as it is read: what is made meanwhile is one piece.
 */
START_TEST(pieces_that_nobody_took_yet_are_one)
{
    static const int made[] = { 12, 24, 48, 64 }; /* taken after the second */
    struct rad_quincunx q = sampler(64, 60);
    struct rad_pixel bottom[64] = { 0 };
    uint8_t density[64], want[64 * 12];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    const struct msg *m;
    struct strict *s;
    uint32_t n, from = 0;

    n = (uint32_t)rad_quincunx_ndensity(&q);
    for (int x = 0; x < 64; x++) {
        const float v[3] = { (float)x, 0, 1 };

        bottom[x].L = (struct rad_rgb){ v[0], v[1], v[2] };
        density[x] = (uint8_t)(100 + x);
        wire_floats_put(want + 12 * x, v, 3);
    }
    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 4);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->true_top);
    for (int i = 0; i < N_ELEM(made); i++) {
        uint32_t to = (uint32_t)made[i], d = n * to / 64;

        strict_bottom(s, p, made[i], d, bottom, density);
        if (i % 2 == 0)
            continue;
        m = strict_message(s, true);
        ck_assert(m && m->type == MSG_BASE_LINE);
        ck_assert_uint_eq(m->base_line.x, from);
        ck_assert_uint_eq(m->base_line.n, to - from);
        ck_assert_uint_eq(m->base_line.first, n * from / 64);
        ck_assert_uint_eq(m->base_line.ndensity, d - n * from / 64);
        ck_assert_mem_eq(m->base_line.density, density + n * from / 64,
                         m->base_line.ndensity);
        ck_assert_mem_eq(m->base_line.pixels, want + 12 * from,
                         12 * (to - from));
        ck_assert_ptr_null(strict_message(s, true));
        from = to;
    }
    strict_ended(s, p, false, bottom, density, &spent, &total);
    strict_free(s);
}
END_TEST

/* A unit that nobody works on gets its top while another is traced ahead. */
START_TEST(what_is_ahead_makes_way_for_the_truth)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 8);
    expect_pass(s, STRICT_LINES, false);
    expect_pass(s, STRICT_AHEAD, false);
    give_unit(s, &q, 1, 10, 12);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_LINES);
    ck_assert(!p->stop);
    give_top(s, &q);
    ck_assert(p->stop);
    strict_ended(s, p, false, bottom, density, &spent, &total);
    expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    expect_pass(s, STRICT_LINES, false); /* once more */
    strict_free(s);
}
END_TEST

static bool
is_said(struct strict *s, enum msg_type type)
{
    const struct msg *m;

    while ((m = strict_message(s, true)))
        if (m->type == type)
            return true;
    return false;
}

/* If its child dies of a pixel, a unit that is made while it is parked has
 * to be known. */
START_TEST(a_parked_unit_that_is_worked_on_says_so)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 6);
    expect_pass(s, STRICT_LINES, false);
    expect_pass(s, STRICT_AHEAD, false);
    ck_assert(is_said(s, MSG_PARKED));
    give_unit(s, &q, 1, 2, 4);
    expect_pass(s, STRICT_LINES, false);
    p = strict_next(s, STRICT_AHEAD); /* of the upper one */
    ck_assert(p && p->unit == 1);
    ck_assert(!is_said(s, MSG_RESUMED));
    strict_ended(s, p, true, NULL, NULL, &spent, &total);
    p = strict_next(s, STRICT_AHEAD); /* which has what the other lacked */
    ck_assert(p && p->unit == 0);
    ck_assert(is_said(s, MSG_RESUMED));
    strict_ended(s, p, true, NULL, NULL, &spent, &total);
    ck_assert(is_said(s, MSG_PARKED));
    strict_free(s);
}
END_TEST

/* What was lent comes back while the unit says that it waits for it. */
START_TEST(a_parked_unit_that_has_its_columns_back_says_so)
{
    const struct msg_back back = { .job = job_id, .attempt = 1, .line = 6 };
    const struct msg_counts none = { 0 };
    struct rad_quincunx q = sampler(64, 60);
    uint8_t wanted[8] = { 0 };
    struct rad_pixel top[64] = { 0 };
    const struct team_loan loan = {
        .line = 6, .x = 6, .n = 6, .wanted = wanted, .top = top, .bottom = top
    };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 7);
    give_top(s, &q);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_TRUTH);
    strict_lent(s, p, &loan);
    strict_blocked(s, p, 6);
    strict_ended(s, p, false, NULL, NULL, &none, &total);
    ck_assert(is_said(s, MSG_PARKED));
    strict_back(s, &back);
    ck_assert(is_said(s, MSG_RESUMED));
    expect_pass(s, STRICT_TRUTH, true);
    ck_assert(!is_said(s, MSG_RESUMED));
    strict_free(s);
}
END_TEST

/* The bottom of a pass under a true top is out, all of it. */
static void
make_bottom(struct strict *s, const struct rad_quincunx *q,
            struct strict_pass *p)
{
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];

    strict_bottom(s, p, 64, rad_quincunx_ndensity(q), bottom, density);
}

/* Rows are wanted by nobody but the picture: what others wait for is made
 * before them, though it lies below, and they go on after it where they were.
 */
START_TEST(rows_make_way_for_a_bottom)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { .primary_rays = 5 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 3);
    expect_pass(s, STRICT_TRUE_LINES, false);
    give_unit(s, &q, 1, 4, 5);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 0 && p->keeps);
    ck_assert(!p->stop);
    give_top(s, &q);
    ck_assert(p->stop);
    p->finished = 2;
    ck_assert(!strict_ended(s, p, false, NULL, NULL, &spent, &total));
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 1);
    make_bottom(s, &q, p); /* then it is no more urgent than the other */
    ck_assert(!p->stop);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_split(s, 0, 1); /* lines that are out are not given away */
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->unit == 0 && p->out == 2 && p->last == 3);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* The base line above a unit comes before it, where the coordinator has it. */
START_TEST(rows_make_way_for_a_unit_that_has_its_top)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 3);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 0 && p->keeps);
    give_top(s, &q);
    ck_assert(!p->stop);
    give_unit(s, &q, 1, 4, 5);
    ck_assert(p->stop);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 1);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* What is made of it counts once, however often it was left. */
START_TEST(rows_that_went_on_count_their_rays_once)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts some = { .rays = 7, .primary_rays = 2 };
    const struct msg_counts all = { .rays = 3, .primary_rays = 5 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 2);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    strict_ended(s, p, false, NULL, NULL, &some, &total);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(strict_ended(s, p, true, bottom, density, &all, &total));
    ck_assert_uint_eq(total.primary_rays, 5);
    ck_assert_uint_eq(total.rays, 10);
    strict_free(s);
}
END_TEST

/* Lines 4 to 7 of 64 columns, of three rows each. */
START_TEST(what_passes_are_past_counts_until_its_rows_are_out)
{
    enum { LINE = 64, UNIT = 4 * 3 * LINE };

    struct rad_quincunx q = sampler(LINE, 60);
    static const struct rad_pixel bottom[LINE];
    static const uint8_t density[LINE];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    ck_assert_int_eq(q.ystep, 3);
    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_uint_eq(strict_pixels(s), 0);
    p->made.base = 2 * LINE;
    ck_assert_uint_eq(strict_pixels(s), 2 * LINE);
    p->made.base = 4 * LINE;
    strict_ended(s, p, true, bottom, density, &spent, &total);
    p = strict_next(s, STRICT_AHEAD); /* goes over the lines again */
    ck_assert_int_eq(p->rank, STRICT_AHEAD);
    p->made = (struct team_made){ .base = LINE, .bars = 2 * LINE };
    ck_assert_uint_eq(strict_pixels(s), 6 * LINE);
    p->made = (struct team_made){ .base = 5 * LINE, .bars = 9 * LINE };
    ck_assert_uint_eq(strict_pixels(s), UNIT);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    give_top(s, &q);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    p->made.out = 5 * LINE;
    ck_assert_uint_eq(strict_pixels(s), UNIT - 5 * LINE);
    p->finished = 6;
    p->stop = true;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    ck_assert_uint_eq(strict_pixels(s), UNIT / 2);
    p = strict_next(s, STRICT_AHEAD);
    p->made.out = 3 * LINE;
    ck_assert_uint_eq(strict_pixels(s), UNIT / 4);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    ck_assert_uint_eq(strict_pixels(s), 0);
    strict_free(s);
}
END_TEST

/* A whole frame keeps no facts: left, it would be traced again. */
START_TEST(rows_that_are_not_kept_do_not_make_way)
{
    struct rad_quincunx q = sampler(64, 61);
    struct rad_quincunx frames[2];
    const struct msg_counts spent = { 0 };
    struct msg_unit below = { .job = job_id, .unit = 1, .attempt = 1 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    frames[0] = frames[1] = q;
    s = strict_new(frames, 2, false, job_id);
    give_unit(s, &q, 0, 0, rad_quincunx_nbases(&q));
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && !p->keeps);
    below.frame = 1;
    below.width = 64;
    below.mode = MSG_MODE_STRICT;
    below.y = (uint32_t)team_line_row(&q, 4);
    below.height = (uint32_t)team_line_row(&q, 5) - below.y;
    ck_assert_int_eq(strict_unit(s, &below, NULL), 0);
    give_top_of(s, &q, 1);
    ck_assert(!p->stop);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* Of two units whose top is there the one whose bottom is out has time. */
START_TEST(who_owes_a_bottom_comes_first)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 2);
    expect_pass(s, STRICT_TRUE_LINES, false);
    give_unit(s, &q, 1, 4, 5);
    give_top(s, &q);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 1);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* Nobody looks again without a reason; for one that waits there is none but
 * that it may wait for long, for a pass what others want of it. */
START_TEST(it_says_when_to_look_again)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_lend lend = { job_id, 0, 1, 32767 };
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    ck_assert_uint_eq(strict_tick(s, 1000), STRICT_NEVER);
    give_unit(s, &q, 0, 4, 8);
    ck_assert(strict_has_work(s));
    ck_assert_uint_eq(strict_tick(s, 1000), STRICT_NEVER);
    expect_pass(s, STRICT_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_uint_eq(strict_tick(s, 1000), STRICT_NEVER);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    ck_assert(!strict_has_work(s));
    ck_assert_uint_eq(strict_tick(s, 2000), 2200); /* its facts are kept */
    ck_assert_uint_eq(strict_tick(s, 2199), 2200);
    ck_assert_uint_eq(strict_tick(s, 2200), STRICT_NEVER);
    give_top(s, &q);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUE_LINES);
    ck_assert_uint_eq(strict_tick(s, 3000), 3010); /* pieces of its bottom */
    strict_ended(s, p, true, bottom, density, &spent, &total);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    ck_assert_uint_eq(strict_tick(s, 3000), STRICT_NEVER);
    strict_lend(s, &lend);
    ck_assert_uint_eq(strict_tick(s, 3000), 3010);
    p->lend = 0;
    ck_assert_uint_eq(strict_tick(s, 3000), STRICT_NEVER);
    strict_twin(s, 0, 1);
    ck_assert_uint_eq(strict_tick(s, 3000), 3010);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    ck_assert_uint_eq(strict_tick(s, 3000), STRICT_NEVER);
    strict_free(s);
}
END_TEST

/* Its top comes again before it does, while a pass of it is ending. */
START_TEST(a_unit_that_was_revoked_and_comes_again_has_its_top)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    strict_revoke(s, 0, 1);
    give_top(s, &q);
    ck_assert(!strict_ended(s, p, false, NULL, NULL, &spent, &total));
    give_unit(s, &q, 0, 4, 8);
    expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* Of the base line above it that one makes ahead, the bar is another's. */
START_TEST(a_top_that_is_made_here_has_no_colours_above)
{
    struct rad_quincunx q = sampler(64, 60);
    struct strict_pass *p;
    struct msg_unit u = { .job = job_id,
                          .attempt = 1,
                          .width = 64,
                          .mode = MSG_MODE_STRICT,
                          .flags = MSG_UNIT_TOP };
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_top(s, &q); /* base line 3 */
    u.y = (uint32_t)team_line_row(&q, 5);
    u.height = (uint32_t)team_line_rows(&q, 5);
    ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->first, 4);
    ck_assert_ptr_nonnull(p->top_density);
    ck_assert_ptr_null(p->top);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* A child may have thousands of units that wait, in the end. To look at all of
 * them at each message must not take the square of that. */
START_TEST(thousands_of_units_may_wait)
{
    enum { N = 3000, WIDE = 3 };
    static const uint8_t pixels[WIDE * 12];
    struct rad_quincunx q = { .width = WIDE, .height = N + 2 };
    struct msg_base_line top = {
        .job = job_id, .n = WIDE, .channels = 3, .pixels = pixels
    };
    struct msg_counts none = { 0 };
    struct strict_pass *p;
    struct strict *s;

    rad_quincunx_steps(1, &q.xstep, &q.ystep);
    s = strict_new(&q, 1, false, job_id);
    for (uint32_t i = 1; i <= N; i++) {
        struct msg_unit u = { .job = job_id,
                              .unit = i,
                              .attempt = 1,
                              .y = i,
                              .width = WIDE,
                              .height = 1,
                              .mode = MSG_MODE_STRICT };

        ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
    }
    for (uint32_t i = N; i-- > 0;) {
        top.line = i;
        strict_base_line(s, &top);
        strict_tick(s, 10 * i);
    }
    p = strict_next(s, STRICT_TRUTH);
    ck_assert_ptr_nonnull(p);
    ck_assert_uint_eq(p->unit, 1);
    ck_assert_int_eq(strict_error(s), 0);
    strict_ended(s, p, false, NULL, NULL, &none, &none);
    strict_free(s);
}
END_TEST

/* The drawings at the head of strict_unit.h, as "from to" pairs. */
START_TEST(unit_states_follow_the_drawings)
{
    static const enum strict_progress progress[][2] = {
        { PROGRESS_NONE, PROGRESS_LINES },
        { PROGRESS_LINES, PROGRESS_AHEAD },
        { PROGRESS_LINES, PROGRESS_GUESSED },
        { PROGRESS_AHEAD, PROGRESS_GUESSED },
        { PROGRESS_AHEAD, PROGRESS_LINES },
    };
    static const enum strict_fate fate[][2] = {
        { FATE_STAYS, FATE_SPLITS }, { FATE_SPLITS, FATE_STAYS },
        { FATE_STAYS, FATE_YIELDS }, { FATE_SPLITS, FATE_YIELDS },
        { FATE_STAYS, FATE_OVER },   { FATE_SPLITS, FATE_OVER },
        { FATE_YIELDS, FATE_OVER },  { FATE_STAYS, FATE_GONE },
        { FATE_SPLITS, FATE_GONE },  { FATE_YIELDS, FATE_GONE },
    };
    int n = 0;

    for (size_t i = 0; i < N_ELEM(progress); i++)
        ck_assert(unit_may_advance(progress[i][0], progress[i][1]));
    for (size_t i = 0; i < N_ELEM(fate); i++)
        ck_assert(unit_may_decide(fate[i][0], fate[i][1]));
    for (int i = 0; i < STRICT_PROGRESSES; i++)
        for (int k = 0; k < STRICT_PROGRESSES; k++)
            n += unit_may_advance((enum strict_progress)i,
                                  (enum strict_progress)k);
    ck_assert_int_eq(n, N_ELEM(progress)); /* and no other */
    n = 0;
    for (int i = 0; i < STRICT_FATES; i++)
        for (int k = 0; k < STRICT_FATES; k++)
            n += unit_may_decide((enum strict_fate)i, (enum strict_fate)k);
    ck_assert_int_eq(n, N_ELEM(fate));
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("strict");
    TCase *tc = tcase_create("strict");

    tcase_add_test(tc, thousands_of_units_may_wait);
    tcase_add_test(tc, bars_that_come_along_stay);
    tcase_add_test(tc, what_leaves_lines_out_fills_no_bars);
    tcase_add_test(tc, a_late_top_lets_the_bottom_go_before_the_first_bar);
    tcase_add_loop_test(tc, a_guess_from_true_densities_is_true, 0,
                        N_ELEM(guesses));
    tcase_add_test(tc, pieces_that_nobody_took_yet_are_one);
    tcase_add_test(tc, what_is_ahead_makes_way_for_the_truth);
    tcase_add_test(tc, a_parked_unit_that_is_worked_on_says_so);
    tcase_add_test(tc, a_parked_unit_that_has_its_columns_back_says_so);
    tcase_add_test(tc, rows_make_way_for_a_bottom);
    tcase_add_test(tc, rows_make_way_for_a_unit_that_has_its_top);
    tcase_add_test(tc, rows_that_went_on_count_their_rays_once);
    tcase_add_test(tc, what_passes_are_past_counts_until_its_rows_are_out);
    tcase_add_test(tc, rows_that_are_not_kept_do_not_make_way);
    tcase_add_test(tc, who_owes_a_bottom_comes_first);
    tcase_add_test(tc, it_says_when_to_look_again);
    tcase_add_test(tc, a_unit_that_was_revoked_and_comes_again_has_its_top);
    tcase_add_test(tc, a_top_that_is_made_here_has_no_colours_above);
    tcase_add_test(tc, a_loan_that_fits_no_line_is_not_taken);
    tcase_add_test(tc, what_lines_cost_is_told);
    tcase_add_test(tc, what_a_loan_traced_for_nothing_is_told);
    tcase_add_test(tc, what_keeps_no_facts_does_not_lend);
    tcase_add_test(tc, a_line_is_left_when_others_are_out);
    tcase_add_test(tc, any_cluster_makes_the_picture_and_rays_of_one_sampler);
    tcase_add_test(tc, unit_states_follow_the_drawings);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
