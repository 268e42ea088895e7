/* child.c - a job's child: it loads, renders units with the real machine and
 * sampler, makes ambient records, and sometimes dies
 *
 * Each of its threads is a fibre that makes a pass of a strict unit, or a
 * window, as the only member of a team.  It runs for some pixels, which then
 * take their virtual time; so messages come in the middle of passes.  The order
 * of steps is that of the real pool. */
#include "config.h"

#include "cluster.h"
#include "task.h"

#include "base/rng.h"
#include "picture/facts.h"
#include "image/hdr.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SLICE_PIXELS 40 /* most pixels between two chances for messages */
#define LATE_MS      20 /* most delay of a tick that the machine wants */

struct sim_task {
    struct task task;
    struct net *net;
    int node;
    float *rows;             /* of the unit, from the first to the last */
    unsigned pixels;         /* that the slice may still trace */
    double used_us, cost_us; /* virtual time of the slice; of the task */
    uint64_t start_ms;
    bool killed; /* by a pixel that kills children */
};

static struct sim_job *
job_of(struct net *net, int node)
{
    return &sim_of(net)->job[sim_child_of(net, node)->job];
}

static int
channels_of(const struct sim_job *job)
{
    return job->spec.flags & MSG_JOB_DEPTH ? 4 : 3;
}

/* Is the child that the event is for still there? */
static bool
alive(struct net *net, const struct event *e)
{
    return net->ops[e->node] && sim_child_of(net, e->node)->conn == e->n;
}

static struct event *
later(struct net *net, int node, unsigned delay,
      void (*fn)(void *net, struct event *e))
{
    struct event *e = net_later(net, delay, fn);

    e->node = node;
    e->n = sim_child_of(net, node)->conn;
    return e;
}

/* --- a child's end --- */

static void
free_task(struct sim_task *t)
{
    task_release(&t->task);
    free(t->rows);
    free(t);
}

/* Give up all tasks, and free the machine. */
static void
unload(struct sim_child *k)
{
    for (int i = 0; i < SIM_THREADS; i++) {
        if (!k->task[i])
            continue;
        task_drop(&k->task[i]->task, k->strict);
        free_task(k->task[i]);
        k->task[i] = NULL;
    }
    k->nwindows = 0;
    strict_free(k->strict);
    k->strict = NULL;
}

static void
die(struct net *net, int node)
{
    struct sim *s = sim_of(net);

    s->crashes++;
    s->job[sim_child_of(net, node)->job].crashes++;
    net->ops[node] = NULL;
    unload(sim_child_of(net, node));
    net_close_all(net, node);
}

/* --- messages to radd --- */

static void
send_tally(struct net *net, int node)
{
    struct sim_child *k = sim_child_of(net, node);
    struct msg m = { .type = MSG_TALLY,
                     .tally = { .job = sim_of(net)->job[k->job].id,
                                .ambient_sent = k->nambient,
                                .busy_s = k->busy_s,
                                .wait_base_line_s = k->busy_s / 4 } };

    if (k->strict)
        strict_dropped(k->strict, &m.tally.dropped);
    net_send_msg(net, node, k->conn, &m);
}

static void
send_ambient(struct net *net, int node)
{
    struct sim_child *k = sim_child_of(net, node);
    uint8_t data[2] = { (uint8_t)k->worker, (uint8_t)k->job };
    struct msg m = { .type = MSG_AMBIENT, .ambient = { 1, data, 2 } };

    k->nambient++;
    net_send_msg(net, node, k->conn, &m);
}

/* Send what the machine has to say. */
static void
speak(struct net *net, int node)
{
    struct sim_child *k = sim_child_of(net, node);
    const struct msg *m;

    while (k->strict && (m = strict_message(k->strict, !net_chance(net, 4)))) {
        sim_of(net)->parked += m->type == MSG_PARKED;
        sim_of(net)->gave += m->type == MSG_GAVE;
        sim_of(net)->loans += m->type == MSG_LOAN;
        net_send_msg(net, node, k->conn, m);
    }
}

/* Code rows of colours as a picture file has them; returns the number of bytes.
 */
static size_t
code_rows(const float *from, uint32_t rows, uint32_t width, uint8_t *to)
{
    struct rad_rgb row[SIM_WIDTH];
    size_t n = 0;

    for (; rows > 0; rows--, from += (size_t)width * 3) {
        for (uint32_t x = 0; x < width; x++)
            row[x] = rad_rgb(from[3 * x], from[3 * x + 1], from[3 * x + 2]);
        n += rad_hdr_encode_row(row, (int)width, to + n);
    }
    return n;
}

/* Send the unit's rows that are made and not sent; last: with these counts, as
 * the last piece. */
static void
send_rows(struct sim_task *sim, const struct msg_counts *last)
{
    struct net *net = sim->net;
    struct task *t = &sim->task;
    struct sim_child *k = sim_child_of(net, sim->node);
    const struct sim_job *job = job_of(net, sim->node);
    size_t stride = (size_t)t->unit.width * (size_t)channels_of(job);
    uint32_t rows = t->nrows - t->nsent;
    uint8_t *bytes = malloc((rows + 1) * RAD_HDR_ROW_BYTES(stride));
    const float *from = sim->rows + t->nsent * stride;
    struct msg m = { .type = MSG_RESULT };
    size_t len = 0;

    SIM_CHECK(net, bytes != NULL);
    if (k->coded)
        len = code_rows(from, rows, t->unit.width, bytes);
    else
        wire_floats_put(bytes, from, rows * stride);
    m.result =
        (struct msg_result){ .job = job->id,
                             .unit = t->unit.unit,
                             .attempt = t->unit.attempt,
                             .row = t->nsent,
                             .rows = rows,
                             .width = t->unit.width,
                             .channels =
                                 k->coded ? 1 : (uint8_t)channels_of(job),
                             .last = last != NULL,
                             .pixels = bytes,
                             .len = len };
    if (last)
        m.result.counts = *last;
    net_send_msg(net, sim->node, k->conn, &m);
    t->nsent = t->nrows;
    free(bytes);
}

/* --- a pass --- */

static bool
is_poison(const struct sim_job *job, uint32_t frame, int x, int y)
{
    return job->poisoned && frame == 0 && x == 0 && y == job->poison_y;
}

static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct sim_task *t = arg;
    struct sim_job *job = job_of(t->net, t->node);

    (void)ctx;
    while (t->pixels == 0 && !t->task.dropped)
        task_yield(&t->task);
    if (!t->task.dropped) {
        t->pixels--;
        t->used_us += sim_pixel_us(job, t->task.unit.frame, x, y);
        t->killed |= is_poison(job, t->task.unit.frame, x, y);
        while (t->killed && !t->task.dropped)
            task_yield(&t->task);
    }
    if (!sim_pixel(job, t->task.unit.frame, x, y, out))
        return false;
    job->traced++;
    return true;
}

static void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct sim_task *t = arg;

    (void)ctx;
    sim_paint(job_of(t->net, t->node), t->task.unit.frame, x0, x1, y, row);
}

static void
on_row(void *arg, int row, const struct rad_pixel *pixels)
{
    struct sim_task *t = arg;
    int channels = channels_of(job_of(t->net, t->node));
    float *to;

    if (t->task.dropped)
        return;
    if (t->task.nrows > t->task.nsent && net_chance(t->net, 4)) {
        speak(t->net, t->node);
        send_rows(t, NULL);
    }
    SIM_CHECK(t->net, (uint32_t)(row - t->task.row0) == t->task.nrows);
    SIM_CHECK(t->net, t->task.nrows < t->task.unit.height);
    to = t->rows +
         (size_t)t->task.nrows++ * t->task.unit.width * (size_t)channels;
    for (uint32_t x = 0; x < t->task.unit.width; x++, to += channels) {
        to[0] = pixels[x].L.r;
        to[1] = pixels[x].L.g;
        to[2] = pixels[x].L.b;
        if (channels == 4)
            to[3] = pixels[x].z;
    }
}

static void slice(void *net, struct event *e);

/* Begin a pass, or a window. */
static void
start_task(struct net *net, int node, int slot, const struct msg_unit *window,
           struct strict_pass *pass)
{
    const struct sim_job *job = job_of(net, node);
    struct sim_task *t = calloc(1, sizeof *t);
    const struct team_spec spec = {
        .sampler = sim_sampler(job, pass ? pass->frame : window->frame),
        .trace = trace,
        .paint = job->paint ? paint : NULL,
        .truth.rows = on_row,
        .arg = t
    };
    const struct msg_unit *u;

    SIM_CHECK(net, t != NULL);
    t->net = net;
    t->node = node;
    t->start_ms = net->now_ms;
    task_begin(&t->task, &spec, pass, window);
    u = &t->task.unit;
    t->rows = calloc((size_t)u->width * u->height * 4 + 1, sizeof *t->rows);
    SIM_CHECK(net, t->rows);
    sim_child_of(net, node)->task[slot] = t;
    later(net, node, 0, slice)->k = slot;
}

/* --- the next task of a thread --- */

/* Give an idle thread its next task; false: there is none. */
static bool
begin(struct net *net, int node, int slot)
{
    struct sim_child *k = sim_child_of(net, node);
    struct strict_pass *p =
        k->strict
            ? strict_next(k->strict, k->nwindows ? STRICT_TRUTH : STRICT_AHEAD)
            : NULL;

    if (!p && k->nwindows == 0)
        return false;
    start_task(net, node, slot, k->windows, p);
    if (!p)
        memmove(k->windows, k->windows + 1,
                --k->nwindows * sizeof k->windows[0]);
    return true;
}

/* Tell the machine how far its passes are, and stop those that it wants
 * stopped. */
static void
look_at_passes(struct sim_child *k)
{
    for (int i = 0; i < SIM_THREADS; i++)
        if (k->task[i])
            task_look(&k->task[i]->task, k->strict);
}

static void look(struct net *net, int node);

static void
tick(void *net, struct event *e)
{
    if (!alive(net, e))
        return;
    sim_child_of(net, e->node)->tick_ms = 0;
    look(net, e->node);
}

/* Tell the machine the time, and when it wants to know it again set an event.
 */
static void
tell_time(struct net *net, int node)
{
    struct sim_child *k = sim_child_of(net, node);
    uint64_t due =
        k->strict ? strict_tick(k->strict, net->now_ms) : STRICT_NEVER;

    if (due == STRICT_NEVER || (k->tick_ms != 0 && k->tick_ms <= due))
        return;
    k->tick_ms = due;
    later(net, node,
          (unsigned)(due - net->now_ms) + net_random(net, LATE_MS) + 1, tick);
}

/* Something has changed: start tasks, and send messages. */
static void
look(struct net *net, int node)
{
    struct sim_child *k = sim_child_of(net, node);
    unsigned threads = sim_of(net)->worker[k->worker].threads;

    if (k->strict) {
        look_at_passes(k);
        look_at_passes(k);
        SIM_CHECK(net, strict_error(k->strict) == 0);
    }
    tell_time(net, node);
    speak(net, node);
    for (unsigned i = 0; i < threads; i++)
        if (!k->task[i] && !begin(net, node, (int)i))
            break;
    tell_time(net, node); /* passes that others wait for may be due */
    speak(net, node);     /* units may have been resumed */
}

/* In some clusters passes that make rows are stopped at any moment, for no
 * reason: so it also happens while columns are lent or lines given away. */
static bool
is_hasty(const struct net *net)
{
    return rad_mix64(net->seed + 80) % 8 == 0;
}

static void
interrupt(struct net *net, const struct task *t)
{
    if (is_hasty(net) && t->pass && t->mode == TEAM_TRUTH && t->pass->keeps &&
        net_chance(net, 4))
        t->pass->stop = true;
}

/* Count what a pass of a strict unit came to. */
static void
note_end(struct net *net, const struct task *t)
{
    int finished;
    bool blocked = team_blocked(t->team, &finished);

    sim_of(net)->blocked += blocked;
    sim_of(net)->aside += !is_hasty(net) && t->mode == TEAM_TRUTH &&
                          !team_done(t->team) && !blocked && t->nrows > 0;
}

/* A task has ended. */
static void
end_task(struct net *net, int node, int slot)
{
    struct sim_child *k = sim_child_of(net, node);
    struct sim_task *t = k->task[slot];
    struct msg_counts spent = { .rays = team_rays(t->task.team),
                                .cpu_s = 1e-6 * t->cost_us },
                      total = { 0 };
    bool whole;

    spent.wall_s = 1e-3 * (double)(net->now_ms - t->start_ms);
    k->busy_s += 1e-6 * t->cost_us;
    k->task[slot] = NULL;
    whole = task_end(&t->task, k->strict, &spent, &total);
    if (t->task.pass)
        note_end(net, &t->task);
    look(net, node);
    if (!whole && t->task.nrows > t->task.nsent)
        send_rows(t, NULL);
    if (whole) {
        send_rows(t, &total);
        if (net_chance(net, 4))
            send_tally(net, node);
        if ((job_of(net, node)->spec.flags & MSG_JOB_SHARE) &&
            net_chance(net, 2))
            send_ambient(net, node);
    }
    free_task(t);
}

/* An event of a task: run its thread for a slice, or end it. */
static void
slice(void *arg, struct event *e)
{
    struct net *net = arg;
    struct sim_child *k;
    struct sim_task *t;
    const struct sim_worker *w;
    double us;

    if (!alive(net, e))
        return;
    k = sim_child_of(net, e->node);
    if (!k->task[e->k] || k->task[e->k]->task.over) {
        if (k->task[e->k])
            end_task(net, e->node, e->k);
        return;
    }
    t = k->task[e->k];
    w = &sim_of(net)->worker[k->worker];
    if (w->stopped_ms > net->now_ms) {
        later(net, e->node, (unsigned)(w->stopped_ms - net->now_ms), slice)->k =
            e->k;
        return;
    }
    interrupt(net, &t->task);
    look_at_passes(k);
    t->pixels = 1 + net_random(net, SLICE_PIXELS);
    task_run(&t->task);
    if (t->killed) {
        die(net, e->node);
        return;
    }
    us = t->used_us * w->slow;
    t->cost_us += us;
    sim_of(net)->work_ms += us / 1000;
    t->used_us = 0;
    later(net, e->node, (unsigned)(us / 1000 + net_random(net, 2)), slice)->k =
        e->k;
    look(net, e->node);
}

/* --- estimates --- */

/* Trace n pixels of an area, the same ones in every child. */
static void
estimate_area(struct net *net, int node, const struct msg_area *a, uint32_t n,
              struct msg_cost *cost)
{
    struct sim_child *k = sim_child_of(net, node);
    struct sim_job *job = job_of(net, node);
    struct rad_quincunx q = sim_sampler(job, a->frame);
    struct rad_facts *f = rad_facts_new((int)a->width, (int)a->height);
    uint8_t *bitmap = calloc(a->height, rad_facts_stride((int)a->width));
    float *v = calloc((size_t)a->width * a->height * 4, sizeof *v);
    struct msg m = { .type = MSG_FACTS };
    size_t count;
    int channels = channels_of(job), line = 0;

    SIM_CHECK(net, f && bitmap && v);
    for (uint32_t i = 0; i < n; i++) {
        uint64_t r = rad_mix64(job->look + a->y * 1000 + i);
        int x = (int)(r % a->width), y = (int)((r >> 32) % a->height);
        struct rad_pixel p;

        cost->tests +=
            sim_pixel_us(job, a->frame, (int)a->x + x, (int)a->y + y);
        cost->rays++;
        if (is_poison(job, a->frame, (int)a->x + x, (int)a->y + y)) {
            die(net, node);
            goto end;
        }
        if (sim_pixel(job, a->frame, (int)a->x + x, (int)a->y + y, &p) &&
            rad_facts_put(f, x, y, &p, RAD_FACT_ESTIMATE))
            job->traced++;
    }
    while (k->strict && team_line_row(&q, line) < (int)a->y)
        line++;
    count =
        rad_facts_export(f,
                         &(struct rad_fact_rows){ 0, (int)a->height, channels,
                                                  RAD_FACT_ESTIMATE },
                         bitmap, v);
    if (k->strict && count > 0) {
        uint8_t *bytes = malloc(count * (size_t)channels * 4);

        SIM_CHECK(net, bytes && team_line_row(&q, line) == (int)a->y);
        wire_floats_put(bytes, v, count * (size_t)channels);
        m.facts = (struct msg_facts){ .job = job->id,
                                      .frame = a->frame,
                                      .line = (uint32_t)line,
                                      .rows = a->height,
                                      .width = a->width,
                                      .flags = MSG_FACTS_ESTIMATE,
                                      .channels = (uint8_t)channels,
                                      .bitmap = bitmap,
                                      .pixels = bytes,
                                      .npixels = (uint32_t)count };
        net_send_msg(net, node, k->conn, &m);
        free(bytes);
    }
end:
    rad_facts_free(f);
    free(bitmap);
    free(v);
}

/* An estimate is made.  e->bytes: the ESTIMATE, packed. */
static void
estimated(void *net, struct event *e)
{
    struct msg m = { 0 }, done = { .type = MSG_ESTIMATED };
    struct msg_cost *v;

    if (!alive(net, e))
        return;
    SIM_CHECK(net, msg_unpack(&m, MSG_ESTIMATE, 0, e->bytes + MSG_HEADER,
                              e->len - MSG_HEADER, NULL) == 0);
    v = calloc(m.estimate.nareas + 1, sizeof *v);
    SIM_CHECK(net, v != NULL);
    for (uint32_t i = 0; i < m.estimate.nareas && alive(net, e); i++) {
        estimate_area(net, e->node, &m.estimate.areas[i], m.estimate.rays,
                      &v[i]);
        done.estimated.counts.rays += v[i].rays;
        done.estimated.counts.estimate_rays += v[i].rays;
    }
    if (!alive(net, e))
        goto end;
    sim_of(net)->estimates++;
    done.estimated.job = job_of(net, e->node)->id;
    done.estimated.id = m.estimate.id;
    done.estimated.ncosts = m.estimate.nareas;
    done.estimated.costs = v;
    net_send_msg(net, e->node, sim_child_of(net, e->node)->conn, &done);
end:
    free(v);
    msg_release(&m);
}

static void
take_estimate(struct net *net, int node, const struct msg *m)
{
    struct wire_out out;
    struct event *e;

    SIM_CHECK(net, sim_cache_serves(sim_of(net), sim_child_of(net, node), 0));
    e = later(net, node, net_random(net, 20 * (m->estimate.nareas + 1)),
              estimated);
    wire_out_init(&out, MSG_FRAME_MAX);
    SIM_CHECK(net, msg_pack(&out, m) == 0);
    event_take(e, out.buf, out.len);
    wire_out_release(&out);
}

/* --- messages --- */

/* Load the job: its frames and, unless it is in windows, the machine of strict
 * units. */
static void
load(struct net *net, int node)
{
    const struct sim_job *job = job_of(net, node);
    struct rad_quincunx q[SIM_FRAMES];
    struct sim_child *k = sim_child_of(net, node);

    for (uint32_t f = 0; f < job->spec.nframes; f++)
        q[f] = sim_sampler(job, f);
    k->frame = job->spec.nframes;
    if (job->spec.partition == MSG_PART_WINDOW)
        return;
    k->strict = strict_new(q, job->spec.nframes, job->paint, job->id);
    SIM_CHECK(net, k->strict != NULL);
}

static void
ready(void *net, struct event *e)
{
    struct sim_child *k = sim_child_of(net, e->node);
    struct msg m = { .type = MSG_READY };

    if (!alive(net, e))
        return;
    m.ready =
        (struct msg_ready){ sim_of(net)->job[k->job].id, .05, 42,
                            (uint16_t)sim_of(net)->worker[k->worker].threads,
                            0 };
    net_send_msg(net, e->node, k->conn, &m);
}

/* As in render_units.c: work at a frame begins; with MSG_JOB_FRESH_FRAMES
 * nothing is kept of another frame. */
static void
begin_frame(struct net *net, int node, uint32_t frame)
{
    struct sim_child *k = sim_child_of(net, node);
    const struct sim_job *job = job_of(net, node);

    if (job->spec.flags & MSG_JOB_FRESH_FRAMES && k->frame != frame &&
        k->frame != job->spec.nframes) {
        unload(k);
        load(net, node);
    }
    k->frame = frame;
}

/* Facts and base lines of a later frame begin it, too. */
static void
begin_lines(struct net *net, int node, uint32_t frame)
{
    const struct sim_child *k = sim_child_of(net, node);
    uint32_t none = job_of(net, node)->spec.nframes;

    SIM_CHECK(net, frame < none);
    if (k->frame == none || frame >= k->frame)
        begin_frame(net, node, frame);
}

static void
take_unit(struct net *net, int node, const struct msg_unit *u)
{
    struct sim_child *k = sim_child_of(net, node);
    struct rad_error err = { 0 };

    SIM_CHECK(net, sim_cache_serves(sim_of(net), k, u->frame));
    begin_frame(net, node, u->frame);
    if (u->mode == MSG_MODE_STRICT) {
        SIM_CHECK(net, k->strict != NULL);
        SIM_CHECK(net, strict_unit(k->strict, u, &err) == 0);
        return;
    }
    SIM_CHECK(net, k->nwindows < sizeof k->windows / sizeof k->windows[0]);
    k->windows[k->nwindows++] = *u;
}

static void
revoke(struct sim_child *k, const struct msg_attempt *r)
{
    for (unsigned i = 0; i < k->nwindows; i++)
        if (k->windows[i].unit == r->unit &&
            k->windows[i].attempt == r->attempt)
            memmove(&k->windows[i], &k->windows[i + 1],
                    (--k->nwindows - i) * sizeof k->windows[0]);
    for (int i = 0; i < SIM_THREADS; i++) {
        const struct task *t = k->task[i] ? &k->task[i]->task : NULL;

        if (t && !t->pass && t->unit.unit == r->unit &&
            t->unit.attempt == r->attempt)
            team_stop(t->team);
    }
    if (k->strict)
        strict_revoke(k->strict, r->unit, r->attempt);
}

static void
take_strict(struct net *net, int node, const struct msg *m)
{
    uint32_t frame;

    SIM_CHECK(net, sim_child_of(net, node)->strict != NULL);
    sim_of(net)->yields += m->type == MSG_YIELD;
    if (strict_brings(m, &frame))
        begin_lines(net, node, frame);
    SIM_CHECK(net, task_message(sim_child_of(net, node)->strict, m));
}

/* Check that ambient records are of the child's job and not its own. */
static void
take_ambient(struct net *net, const struct sim_child *k,
             const struct msg_ambient *m)
{
    SIM_CHECK(net, m->len == 2 * (size_t)m->count);
    for (uint32_t i = 0; i < m->count; i++) {
        SIM_CHECK(net, m->data[2 * i] != k->worker);
        SIM_CHECK(net, m->data[2 * i + 1] == k->job);
    }
}

static void
message(struct net *net, int node, uint64_t conn, const struct msg *m)
{
    struct sim_child *k = sim_child_of(net, node);

    switch (m->type) {
    case MSG_JOB_START:
        SIM_CHECK(net, !k->started);
        k->started = true;
        k->job = sim_find_job(sim_of(net), m->job_start.job);
        k->coded = m->job_start.flags & MSG_JOB_CODED;
        load(net, node);
        net_session(net, node, conn, MSG_AT_CHILD, MSG_VERSION);
        later(net, node, net_random(net, 300), ready);
        return;
    case MSG_UNIT:
        take_unit(net, node, &m->unit);
        break;
    case MSG_REVOKE:
        revoke(k, &m->revoke);
        break;
    case MSG_SPLIT:
    case MSG_YIELD:
    case MSG_LEND:
    case MSG_LOAN:
    case MSG_BACK:
    case MSG_FACTS:
    case MSG_BASE_LINE:
    case MSG_GUESS:
        take_strict(net, node, m);
        break;
    case MSG_TILE:
        sim_take_tile(net, node, &m->tile);
        return;
    case MSG_FROZEN:
        sim_take_frozen(net, node, &m->frozen);
        return;
    case MSG_STAGE:
        sim_take_stage(net, node, &m->stage);
        return;
    case MSG_SHOW:
        sim_take_show(net, node, &m->show);
        return;
    case MSG_ESTIMATE:
        take_estimate(net, node, m);
        break;
    case MSG_AMBIENT:
        take_ambient(net, k, &m->ambient);
        break;
    case MSG_JOB_END:
        unload(k);
        send_tally(net, node);
        return;
    }
    look(net, node);
}

/* The child's worker has closed the link: the child ends. */
static void
closed(struct net *net, int node, uint64_t conn)
{
    (void)conn;
    unload(sim_child_of(net, node));
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

/* Kill a child: the worker hears nothing more of it. */
void
sim_kill(struct sim *s, int worker, uint64_t conn)
{
    if (net_find(&s->net, NODE_WORKER + worker, conn))
        net_close(&s->net, NODE_WORKER + worker, conn);
}

void
sim_crash(struct sim *s, int child)
{
    const struct sim_child *k = &s->child[child];
    struct sim_job *job = &s->job[k->job];

    /* only once in a job: by a second crash the unit would be a suspect */
    if (!s->net.ops[NODE_CHILD + child] || !k->started || job->crashes > 0)
        return;
    die(&s->net, NODE_CHILD + child);
}

void
sim_children_release(struct sim *s)
{
    for (int i = 0; i < SIM_CHILDREN; i++)
        unload(&s->child[i]);
}
