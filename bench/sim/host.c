/* host.c - see host.h
 *
 * What comes in to its child, what its threads do next, and what goes out.  A
 * thread takes its next work as one of the real pool does (pool_thread.c): a
 * tile, an estimate or a window, a pass of strict units, which others join. */
#include "config.h"

#include "host_impl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TICK_US 10000 /* of strict_tick() */

size_t
host_size(void)
{
    return sizeof(struct host);
}

struct host *
host_at(const struct cluster *c, int i)
{
    return &c->hosts[i];
}

const struct map *
host_map(const struct host *h)
{
    return h->cluster->spec->map;
}

void
host_later(struct host *h, double delay_us,
           void (*fn)(void *arg, struct event *e))
{
    struct event e = { .at = h->cluster->now_us + (uint64_t)ceil(delay_us),
                       .fn = fn,
                       .node = h->number,
                       .n = h->life };

    events_add(&h->cluster->events, &e);
}

struct host *
host_alive(void *arg, const struct event *e)
{
    struct host *h = host_at(arg, e->node);

    return h->life == e->n ? h : NULL;
}

struct msg_counts
host_counts(const struct host *h, double seconds, double wall_s,
            uint64_t pixels)
{
    double rays = seconds * h->speed * RAYS_PER_S;

    return (struct msg_counts){ .rays = (uint64_t)rays,
                                .primary_rays = pixels,
                                .intersection_tests = (uint64_t)(3 * rays),
                                .cpu_s = seconds,
                                .wall_s = wall_s };
}

/* Work costs more where it is done twice over. */
double
host_seconds(const struct host *h, double cost)
{
    const struct cluster_spec *s = h->cluster->spec;

    return cost * (1 + s->growth * log2(s->hosts)) / h->speed;
}

void
host_spend(struct host_thread *t, double seconds,
           void (*fn)(void *arg, struct event *e))
{
    struct host *h = t->host;
    struct event e = { .at = h->cluster->now_us + (uint64_t)ceil(1e6 * seconds),
                       .fn = fn,
                       .node = h->number,
                       .n = h->life,
                       .k = (int)(t - h->thread),
                       .len = ++t->step };

    t->working = true;
    events_add(&h->cluster->events, &e);
}

struct host_thread *
host_rests(void *arg, const struct event *e)
{
    struct host *h = host_alive(arg, e);
    struct host_thread *t = h ? &h->thread[e->k] : NULL;

    if (!t || t->step != e->len)
        return NULL;
    host_time_note(t);
    t->working = false;
    return t;
}

static void
take_unit(struct host *h, const struct msg_unit *u)
{
    struct rad_error err = { 0 };

    if (u->mode != MSG_MODE_STRICT) {
        host_errand_window(h, u);
        return;
    }
    if (strict_unit(h->strict, u, &err) < 0) {
        fprintf(stderr, "sim: %s: %s\n", h->name, err.what);
        abort();
    }
    h->lines = true;
}

/* Let a thread that does nothing go on; false: it has to wait. */
static bool
go_on(struct host_thread *t)
{
    if (t->working || t->waits)
        return false;
    if (t->pass) {
        host_pass_trace(t);
        return true;
    }
    if (host_tiles_begin(t))
        return true;
    return !host_tiles_change(t->host) &&
           (host_errand_begin(t) || host_pass_begin(t));
}

/* Threads may give each other work. */
static void
work(struct host *h)
{
    bool went = true;

    while (went) {
        went = false;
        for (int i = 0; i < h->cluster->spec->threads; i++)
            while (go_on(&h->thread[i]))
                went = true;
    }
}

void
host_flush(struct host *h)
{
    const struct msg *m;

    while ((m = strict_message(h->strict, true)))
        host_say(h, m);
}

static void
tick(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);

    if (!h)
        return;
    h->ticking = false;
    if (!h->strict)
        return;
    strict_tick(h->strict, h->cluster->now_us / 1000);
    host_go_on(h);
}

void
host_go_on(struct host *h)
{
    host_pass_look(h);
    host_pass_look(h);
    work(h);
    host_flush(h);
    host_time_wait(h);
    host_time_look(h);
    if (!h->ticking && h->lines) {
        h->ticking = true;
        host_later(h, TICK_US, tick);
    }
}

static void
ready(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);
    struct msg m = { .type = MSG_READY };

    if (!h)
        return;
    m.ready =
        (struct msg_ready){ h->cluster->job, 1e-6 * h->cluster->spec->load_us,
                            42, (uint16_t)h->cluster->spec->threads, 0 };
    host_say(h, &m);
    h->ready = true;
    host_time_look(h);
}

static void
start_job(struct host *h)
{
    const struct map *m = host_map(h);

    h->strict = strict_new(h->frames, m->nframes, false, h->cluster->job);
    if (!h->strict)
        abort();
    host_later(h, h->cluster->spec->load_us / h->speed, ready);
}

void
host_child_message(struct host *h, const struct msg *m)
{
    if (m->type == MSG_JOB_START && !h->strict)
        start_job(h);
    if (!h->strict)
        return;
    switch (m->type) {
    case MSG_UNIT:
        take_unit(h, &m->unit);
        break;
    case MSG_REVOKE:
        strict_revoke(h->strict, m->revoke.unit, m->revoke.attempt);
        host_errand_revoke(h, &m->revoke);
        break;
    case MSG_ESTIMATE:
        host_errand_estimate(h, &m->estimate);
        break;
    default:
        h->lines |= m->type == MSG_LOAN;
        if (!task_message(h->strict, m) && !host_tiles_message(h, m))
            return;
    }
    host_go_on(h);
}

void
host_child_over(struct host *h)
{
    host_time_look(h);
    h->life++;
    h->ready = false;
    host_passes_drop(h);
    strict_free(h->strict);
    h->strict = NULL;
    host_tiles_forget(h);
    host_errands_forget(h);
    for (int i = 0; i < h->cluster->spec->threads; i++)
        h->thread[i].working = false;
    host_time_look(h);
    h->lines = h->ticking = false;
    h->idle = 0;
}

static void
start_again(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);

    if (h)
        host_start(arg, h);
}

void
host_fail(struct cluster *c, struct host *h)
{
    host_child_over(h);
    host_radd_dies(h);
    host_later(h, c->spec->back_us, start_again);
}

void
host_init(struct cluster *c, struct host *h, int number, double speed)
{
    const struct map *m = c->spec->map;

    h->cluster = c;
    h->number = number;
    h->speed = speed;
    h->thread = sim_alloc((size_t)c->spec->threads * sizeof *h->thread);
    h->tile =
        sim_alloc((size_t)c->spec->threads * HOST_MOST_TILES * sizeof *h->tile);
    for (int i = 0; i < c->spec->threads; i++)
        h->thread[i] =
            (struct host_thread){ .host = h, .at_tiles = HOST_STATES };
    snprintf(h->name, sizeof h->name, "w%d", number);
    snprintf(h->address, sizeof h->address, "sim %d", number);
    h->frames = sim_alloc(m->nframes * sizeof *h->frames);
    for (uint32_t k = 0; k < m->nframes; k++)
        h->frames[k] = m->q;
    h->code = sim_alloc(host_rows_room(h));
}

void
host_release(struct host *h)
{
    host_child_over(h);
    host_radd_release(h);
    free(h->thread);
    free(h->tile);
    free(h->frames);
    free(h->code);
}
