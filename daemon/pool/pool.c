/* pool.c - see pool.h; files as in pool_impl.h */
#include "config.h"

#include "pool/pool_impl.h"

#include "net/log.h"

#include <pthread.h>
#include <stdlib.h>

/* Hand on tiles that are made; report a failure as that of a unit. */
static void
give_tiles(struct pool *p)
{
    struct pool_rows failed = { 0 };

    if (pool_give_tiles(p, &failed.err) != 0)
        p->rows(p->arg, &failed);
}

static void
on_wake(void *arg)
{
    struct pool *p = arg;
    struct pool_rows *r, *next;

    uv_mutex_lock(&p->mu);
    r = p->done;
    p->done = NULL;
    p->done_end = &p->done;
    uv_mutex_unlock(&p->mu);
    if (p->tiling.fn)
        give_tiles(p);
    if (p->strict)
        p->news(p->arg);
    for (; r; r = next) {
        next = r->next;
        p->rows(p->arg, r);
        free(r);
    }
    pool_give_estimates(p);
}

bool
pool_push(struct pool *p, const struct pool_unit *u)
{
    struct queued *q = calloc(1, sizeof *q);

    if (!q)
        return false;
    q->unit = *u;
    uv_mutex_lock(&p->mu);
    *p->todo_end = q;
    p->todo_end = &q->next;
    uv_cond_signal(&p->work);
    uv_mutex_unlock(&p->mu);
    return true;
}

static bool
same_unit(const struct pool_unit *u, uint32_t unit, uint32_t attempt)
{
    return u->unit == unit && u->attempt == attempt;
}

void
pool_revoke(struct pool *p, uint32_t unit, uint32_t attempt)
{
    struct queued **at, *gone = NULL;

    uv_mutex_lock(&p->mu);
    for (at = &p->todo; *at; at = &(*at)->next)
        if (same_unit(&(*at)->unit, unit, attempt)) {
            gone = *at;
            *at = gone->next;
            if (!*at)
                p->todo_end = at;
            break;
        }
    for (struct active *u = p->active; u; u = u->next)
        if (!u->pass && same_unit(&u->unit, unit, attempt))
            team_stop(u->team);
    if (p->strict) {
        strict_revoke(p->strict, unit, attempt);
        pool_changed_locked(p);
    }
    uv_mutex_unlock(&p->mu);
    free(gone);
}

void
pool_sent(struct pool *p, size_t n)
{
    uv_mutex_lock(&p->mu);
    p->unsent -= n < p->unsent ? n : p->unsent;
    if (p->unsent <= POOL_UNSENT)
        uv_cond_broadcast(&p->room);
    uv_mutex_unlock(&p->mu);
}

void
pool_settle(struct pool *p)
{
    uv_mutex_lock(&p->mu);
    pool_settle_waits_locked(p);
    for (struct active *u = p->active; u; u = u->next)
        if (u->pass)
            u->pass->made = team_made(u->team);
    uv_mutex_unlock(&p->mu);
}

struct pool_tally
pool_tally(struct pool *p)
{
    struct pool_tally t = { 0 };

    uv_mutex_lock(&p->mu);
    t.busy_s = p->busy_s;
    t.wait_base_line_s = p->wait_s;
    for (const struct active *u = p->active; u; u = u->next) {
        t.wait_base_line_s += team_waited(u->team);
        t.rays_under_way += team_rays(u->team);
    }
    if (p->strict) {
        t.rays_under_way += strict_rays(p->strict);
        t.pixels_under_way = strict_pixels(p->strict);
        strict_dropped(p->strict, &t.dropped);
    }
    msg_counts_add(&t.dropped, &p->tiling.dropped);
    uv_mutex_unlock(&p->mu);
    return t;
}

/* Processor time of a thread. */
static double
cpu_of(const struct renderer *by)
{
    clockid_t clock;

    return pthread_getcpuclockid(by->thread, &clock) == 0 ? pool_seconds(clock)
                                                          : 0;
}

bool
pool_stuck(struct pool *p, double limit_s, int *x, int *y)
{
    bool stuck = false;

    for (int i = 0; i < p->nthreads && limit_s > 0 && !stuck; i++) {
        struct renderer *by = &p->renderers[i];
        uint64_t at = atomic_load_explicit(&by->ctx.at, memory_order_relaxed);
        double cpu = cpu_of(by);

        if (at != by->seen)
            by->seen_cpu = cpu;
        by->seen = at;
        stuck = at != 0 && cpu - by->seen_cpu > limit_s;
        *x = RAD_AT_X(at);
        *y = RAD_AT_Y(at);
    }
    return stuck;
}

static void
wake_closed(uv_handle_t *h)
{
    struct pool *p = h->data;

    uv_mutex_destroy(&p->mu);
    uv_cond_destroy(&p->work);
    uv_cond_destroy(&p->room);
    free(p->renderers);
    free(p);
}

void
pool_free(struct pool *p)
{
    if (!p)
        return;
    uv_mutex_lock(&p->mu);
    atomic_store(&p->stopping, true);
    for (int i = 0; i < MSG_OPEN_PASSES; i++)
        atomic_store(&p->tiling.stop[i], true);
    for (struct active *u = p->active; u; u = u->next)
        team_stop(u->team);
    uv_cond_broadcast(&p->work);
    uv_cond_broadcast(&p->room);
    uv_mutex_unlock(&p->mu);
    for (int i = 0; i < p->nthreads; i++) {
        uv_thread_join(&p->renderers[i].thread);
        rad_ctx_release(&p->renderers[i].ctx);
    }
    while (p->todo) {
        struct queued *q = p->todo;

        p->todo = q->next;
        free(q);
    }
    while (p->done) {
        struct pool_rows *r = p->done;

        p->done = r->next;
        free(r);
    }
    pool_free_estimates(p->estimates);
    pool_free_estimates(p->estimated);
    pool_release_tiles(p);
    wake_close(&p->wake, wake_closed);
}

/* Sets p->nthreads to the threads that run, even if one fails to start. */
static int
start_threads(struct pool *p, int nthreads, struct rad_error *err)
{
    for (int i = 0; i < nthreads; i++) {
        struct renderer *by = &p->renderers[i];
        int rc = rad_ctx_init(&by->ctx, p->job, err);

        if (rc < 0)
            return rc;
        by->ctx.scratch.on_lack = log_out_of_memory; /* no pixel is wrong */
        by->pool = p;
        rc = uv_thread_create(&by->thread, pool_run_thread, by);
        if (rc < 0) {
            rad_ctx_release(&by->ctx);
            return rad_fail(err, RAD_ENOMEM, "cannot start thread %d: %s", i,
                            uv_strerror(rc));
        }
        p->nthreads = i + 1;
    }
    return 0;
}

/* Memory, and what wakes the loop. */
static struct pool *
make_pool(uv_loop_t *loop, int nthreads, struct rad_error *err)
{
    struct pool *p = calloc(1, sizeof *p);
    struct renderer *renderers = calloc((size_t)nthreads, sizeof *renderers);
    int rc = UV_ENOMEM;

    if (p && renderers)
        rc = wake_init(&p->wake, loop, on_wake, p);
    if (rc == 0) {
        p->renderers = renderers;
        return p;
    }
    free(renderers);
    free(p);
    rad_fail(err, RAD_ENOMEM, "cannot set threads up: %s", uv_strerror(rc));
    return NULL;
}

struct pool *
pool_new(uv_loop_t *loop, const struct pool_spec *spec, struct rad_error *err)
{
    struct pool *p = make_pool(loop, spec->nthreads, err);

    if (!p)
        return NULL;
    p->job = spec->job;
    p->frames = spec->frames;
    p->strict = spec->strict;
    p->coded = spec->coded;
    p->rows = spec->rows;
    p->news = spec->news;
    p->arg = spec->arg;
    p->todo_end = &p->todo;
    p->done_end = &p->done;
    p->tiling.todo_end = &p->tiling.todo;
    p->tiling.frozen_end = &p->tiling.frozen;
    uv_mutex_init(&p->mu);
    uv_cond_init(&p->work);
    uv_cond_init(&p->room);
    if (start_threads(p, spec->nthreads, err) < 0) {
        pool_free(p);
        return NULL;
    }
    return p;
}
