/* pool_first.c - work of threads before the first unit: seeding the ambient
 * cache, and estimates */
#include "config.h"

#include "child/pool_impl.h"
#include "machine/counted.h"

#include <stdlib.h>

/* --- estimates --- */

struct estimating *
first_find_estimate_locked(const struct pool *p)
{
    struct estimating *e = p->estimates;

    while (e && (atomic_load(&e->stop) || !estimate_open(e->estimate)))
        e = e->next;
    return e;
}

bool
first_is_estimating_locked(const struct pool *p)
{
    const struct estimating *e = p->estimates;

    while (e && e->members == 0)
        e = e->next;
    return e != NULL;
}

/* No thread is left at the estimate: hand it to the loop. */
static void
end_estimate_locked(struct pool *p, struct estimating *e)
{
    struct estimating **at = &p->estimates;

    while (*at != e)
        at = &(*at)->next;
    *at = e->next;
    e->wall_s = pool_seconds(CLOCK_MONOTONIC) - e->wall_s;
    e->next = p->estimated;
    p->estimated = e;
    uv_async_send(&p->async);
}

void
first_work_on_estimate(struct renderer *by, struct estimating *e)
{
    struct pool *p = by->pool;
    struct pool_stint stint = pool_stint_begin(by);
    double cpu;

    estimate_work(e->estimate, &by->ctx, &e->stop);
    cpu = pool_stint_end_and_lock(by, &stint);
    estimate_count(e->estimate, &by->ctx.counts, cpu);
    if (--e->members == 0 &&
        (atomic_load(&e->stop) || !estimate_open(e->estimate)))
        end_estimate_locked(p, e);
    uv_mutex_unlock(&p->mu);
}

void
first_give_estimates(struct pool *p)
{
    struct estimating *e, *next;

    uv_mutex_lock(&p->mu);
    e = p->estimated;
    p->estimated = NULL;
    uv_mutex_unlock(&p->mu);
    for (; e; e = next) {
        next = e->next;
        e->fn(p->arg, e->estimate, e->wall_s);
        free(e);
    }
}

bool
pool_estimate(struct pool *p, struct estimate *estimate, pool_estimate_fn *fn)
{
    struct estimating *e = calloc(1, sizeof *e);

    if (!e)
        return false;
    e->estimate = estimate;
    e->fn = fn;
    e->wall_s = pool_seconds(CLOCK_MONOTONIC);
    uv_mutex_lock(&p->mu);
    e->next = p->estimates;
    p->estimates = e;
    if (estimate_open(estimate))
        uv_cond_broadcast(&p->work);
    else
        end_estimate_locked(p, e); /* no areas */
    uv_mutex_unlock(&p->mu);
    return true;
}

void
first_free_estimates(struct estimating *e)
{
    while (e) {
        struct estimating *next = e->next;

        estimate_free(e->estimate);
        free(e);
        e = next;
    }
}

/* --- seeding --- */

/* Seeding is over: tell the loop. */
static void
end_seed_locked(struct pool *p)
{
    p->seeded_one = p->seed;
    p->seed = NULL;
    uv_async_send(&p->async);
}

/* The last thread has ended a step of seeding: begin the next step, or end
 * seeding.  Until then other threads find no piece to begin. */
static void
go_on_seeding_locked(struct pool *p, struct rad_seed *s)
{
    bool more;

    uv_mutex_unlock(&p->mu);
    more = rad_seed_next(s);
    uv_mutex_lock(&p->mu);
    p->seed_over = !more;
    uv_cond_broadcast(&p->work);
}

void
first_work_on_seed(struct renderer *by, struct rad_seed *s)
{
    struct pool *p = by->pool;
    struct pool_stint stint = pool_stint_begin(by);
    double cpu;

    rad_seed_work(s, &by->ctx, &p->seed_stop);
    cpu = pool_stint_end_and_lock(by, &stint);
    counted_add(&p->seeded, &by->ctx.counts, cpu);
    if (p->seeding == 1 && !atomic_load(&p->seed_stop) && !rad_seed_open(s))
        go_on_seeding_locked(p, s);
    if (--p->seeding == 0 && (p->seed_over || atomic_load(&p->seed_stop)))
        end_seed_locked(p);
    uv_mutex_unlock(&p->mu);
}

void
first_end_seed(struct pool *p)
{
    struct rad_seed *s;
    pool_seed_fn *fn;

    uv_mutex_lock(&p->mu);
    s = p->seeded_one;
    fn = p->seed_fn;
    p->seeded_one = NULL;
    uv_mutex_unlock(&p->mu);
    if (!s)
        return;
    rad_seed_free(s);
    fn(p->arg);
}

void
pool_seed(struct pool *p, struct rad_seed *s, pool_seed_fn *fn)
{
    uv_mutex_lock(&p->mu);
    p->seed = s;
    p->seed_fn = fn;
    p->seed_over = false;
    atomic_store(&p->seed_stop, false);
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

/* --- something comes first --- */

void
first_stop_locked(struct pool *p)
{
    atomic_store(&p->seed_stop, true);
    for (struct estimating *e = p->estimates; e; e = e->next)
        atomic_store(&e->stop, true);
}

void
pool_rest(struct pool *p)
{
    struct estimating *e, *next;

    uv_mutex_lock(&p->mu);
    first_stop_locked(p);
    if (p->seed && p->seeding == 0)
        end_seed_locked(p);
    for (e = p->estimates; e; e = next) {
        next = e->next;
        if (e->members == 0)
            end_estimate_locked(p, e);
    }
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}
