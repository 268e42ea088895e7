/* host.c - see host.h
 *
 * What comes in to its child, what that does next, and what goes out.  The
 * child has one team, as fast as the host, which does one thing after the
 * other: a pass of strict units, an estimate, a window.  */
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
host_spend(struct host *h, double seconds,
           void (*fn)(void *arg, struct event *e))
{
    h->busy_s += seconds;
    h->working = true;
    host_later(h, 1e6 * seconds, fn);
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

static void
work(struct host *h)
{
    while (!h->working) {
        if (host_tiles_begin(h)) {
            return;
        } else if (h->task.team) {
            if (host_pass_trace(h))
                return;
        } else if (!host_errand_begin(h) && !host_pass_begin(h)) {
            return;
        }
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
    task_look(&h->task, h->strict);
    task_look(&h->task, h->strict);
    work(h);
    host_flush(h);
    host_time_wait(h);
    if (host_time_state(h) != h->state)
        host_time_note(h, host_time_state(h));
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
    m.ready = (struct msg_ready){ h->cluster->job,
                                  1e-6 * h->cluster->spec->load_us, 42, 1, 0 };
    host_say(h, &m);
    h->ready = true;
    host_time_note(h, HOST_EMPTY);
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
    h->life++;
    h->ready = false;
    host_time_note(h, HOST_LOADS);
    task_drop(&h->task, h->strict);
    h->owed = 0;
    strict_free(h->strict);
    h->strict = NULL;
    host_tiles_forget(h);
    host_errands_forget(h);
    h->lines = h->working = h->ticking = false;
    h->idle_us = 0;
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
    h->at_tiles = HOST_STATES;
    h->speed = speed;
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
    free(h->frames);
    free(h->code);
}
