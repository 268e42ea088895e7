/* host_pass.c - passes of strict units, by the real team (tests/sim/task.h)
 *
 * A thread is in a team as a fibre of its own.  A pixel that it traces costs
 * its part of the row (map.h).  Costs gather up to a slice, which then takes
 * its time; so nothing is early by more than that.  Where a real thread would
 * sleep until the thread on the line above is further, the fibre yields: the
 * program is linked with __wrap_uv_cond_wait() and its like below. */
#include "config.h"

#include "host_impl.h"

#include "tests/sim/fibre.h"

#include <stdio.h>
#include <stdlib.h>

#define SLICES 64 /* of a line of mean cost */

struct host_pass {
    struct host_pass *next;
    struct host *host;
    struct task task;
    int threads;   /* that have not left: of some the last cost is to be paid */
    double pass_s; /* of the task so far */
};

/* --- sleep and wake --- */

static struct host_thread *running; /* whose fibre runs */
static struct host_thread *waiting; /* all that wait */

void __wrap_uv_cond_wait(uv_cond_t *c, uv_mutex_t *m);
void __wrap_uv_cond_signal(uv_cond_t *c);
void __wrap_uv_cond_broadcast(uv_cond_t *c);

void
__wrap_uv_cond_wait(uv_cond_t *c, uv_mutex_t *m)
{
    struct host_thread *t = running;

    t->waits = c;
    t->next = waiting;
    waiting = t;
    uv_mutex_unlock(m);
    fibre_yield(t->fibre);
    uv_mutex_lock(m);
}

static void
wake(const uv_cond_t *c)
{
    struct host_thread **at = &waiting, *t;

    while ((t = *at))
        if (t->waits == c) {
            *at = t->next;
            t->waits = NULL;
        } else {
            at = &t->next;
        }
}

void
__wrap_uv_cond_signal(uv_cond_t *c)
{
    wake(c);
}

void
__wrap_uv_cond_broadcast(uv_cond_t *c)
{
    wake(c);
}

/* --- callbacks of a team --- */

/* Let what the thread traced take its time. */
static void
pay(const struct host_pass *p)
{
    if (!p->task.dropped && running->owed > 0)
        fibre_yield(running->fibre);
}

static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct host_pass *p = arg;
    const struct map *m = host_map(p->host);

    (void)ctx;
    *out = (struct rad_pixel){ .L = map_pixel(m, x, y) };
    if (p->task.dropped)
        return true;
    p->host->traced++;
    running->owed += map_pixel_cost(m, p->task.unit.frame, y);
    if (running->owed * m->nframes * m->nlines * SLICES > m->total)
        pay(p);
    return true;
}

/* Send the rows that are made and not sent; total: what the unit cost, if they
 * are its last. */
static void
send_rows(struct host_pass *p, const struct msg_counts *total)
{
    struct task *t = &p->task;

    host_rows_send(p->host, &t->unit, t->nsent, t->nrows - t->nsent, total);
    t->nsent = t->nrows;
}

static void
on_row(void *arg, int row, const struct rad_pixel *pixels)
{
    struct host_pass *p = arg;
    struct task *t = &p->task;

    (void)row;
    (void)pixels;
    pay(p);
    if (t->dropped)
        return;
    if (t->nrows - t->nsent >= host_rows_piece(p->host, t->unit.width))
        send_rows(p, NULL);
    t->nrows++;
}

/* The bottom goes out before the bar above it is begun. */
static void
on_bottom(void *arg)
{
    pay(arg);
}

/* --- a pass --- */

static struct host_pass *
begin(struct host *h, struct strict_pass *pass)
{
    struct host_pass *p = sim_alloc(sizeof *p);
    const struct team_spec spec = { .sampler = host_map(h)->q,
                                    .trace = trace,
                                    .truth.rows = on_row,
                                    .bottom = on_bottom,
                                    .arg = p,
                                    .nthreads = h->cluster->spec->threads };

    p->host = h;
    p->next = h->teams;
    h->teams = p;
    task_begin(&p->task, &spec, pass, NULL);
    return p;
}

/* A team with lines left to begin, at least as urgent as `least`. */
static struct host_pass *
find_open(const struct host *h, enum strict_rank least)
{
    struct host_pass *p = h->teams;

    while (p && (p->task.pass->rank > least || !team_open(p->task.team)))
        p = p->next;
    return p;
}

/* Find work at least as urgent as `least`: a pass to begin, or to help with. */
static bool
find(struct host_thread *t, enum strict_rank least)
{
    struct strict_pass *pass = strict_next(t->host->strict, least);

    if (pass) {
        t->pass = begin(t->host, pass);
        t->fibre = t->pass->task.fibre[0];
    } else if ((t->pass = find_open(t->host, least))) {
        t->fibre = task_join(&t->pass->task);
    }
    if (t->pass)
        t->pass->threads++;
    return t->pass;
}

/* Find a team with blocks to help with, the most urgent first. */
static bool
find_help(struct host_thread *t)
{
    struct host_pass *best = NULL;

    for (struct host_pass *p = t->host->teams; p; p = p->next)
        if ((!best || p->task.pass->rank < best->task.pass->rank) &&
            team_helps(p->task.team))
            best = p;
    if (!best)
        return false;
    t->pass = best;
    t->fibre = task_join(&best->task);
    best->threads++;
    return true;
}

bool
host_pass_begin(struct host_thread *t)
{
    if (!find(t, STRICT_TRUTH) && !find(t, STRICT_LINES) &&
        !find(t, STRICT_AHEAD) && !find_help(t))
        return false;
    host_time_tell(t, "begins");
    return true;
}

/* The last member has left: the pass ends. */
static void
end(struct host_pass *p)
{
    struct host *h = p->host;
    struct msg_counts spent = host_counts(h, p->pass_s, p->pass_s, 0), total;
    struct host_pass **at = &h->teams;
    bool whole = task_end(&p->task, h->strict, &spent, &total);

    host_flush(h);
    if (whole || p->task.nrows > p->task.nsent)
        send_rows(p, whole ? &total : NULL);
    while (*at != p)
        at = &(*at)->next;
    *at = p->next;
    task_release(&p->task);
    free(p);
}

static void
paid(void *arg, struct event *e)
{
    const struct host_thread *t = host_rests(arg, e);

    if (t)
        host_go_on(t->host);
}

void
host_pass_trace(struct host_thread *t)
{
    struct host_pass *p = t->pass;
    double seconds;

    running = t;
    fibre_run(t->fibre);
    if (t->owed > 0) {
        seconds = host_seconds(t->host, t->owed);
        t->owed = 0;
        p->pass_s += seconds;
        t->host->busy_s += seconds;
        host_spend(t, seconds, paid);
    } else if (!t->waits) {
        t->pass = NULL;
        if (--p->threads == 0)
            end(p);
    }
}

void
host_pass_look(struct host *h)
{
    for (struct host_pass *p = h->teams; p; p = p->next)
        task_look(&p->task, h->strict);
}

void
host_passes_drop(struct host *h)
{
    struct host_pass *p;

    for (int i = 0; i < h->cluster->spec->threads; i++) {
        if (h->thread[i].waits)
            wake(h->thread[i].waits);
        h->thread[i].pass = NULL;
        h->thread[i].owed = 0;
    }
    while ((p = h->teams)) {
        h->teams = p->next;
        task_drop(&p->task, h->strict);
        free(p);
    }
}

enum host_state
host_pass_state(const struct host_pass *p)
{
    const struct strict_pass *s = p->task.pass;

    return strict_has_true_top(s) || s->spec.loan ? HOST_TRUTH : HOST_AHEAD;
}

void
host_pass_tell(const struct host_pass *p)
{
    const struct strict_pass *s = p->task.pass;

    printf(" unit=%u attempt=%u mode=%d lines=%d-%d%s", s->unit, s->attempt,
           (int)s->spec.mode, s->spec.first, s->spec.last,
           s->spec.loan ? " loan" : "");
}
