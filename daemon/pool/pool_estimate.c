/* pool_estimate.c - estimates in the pool: threads work on them before units */
#include "config.h"

#include "pool/pool_impl.h"

#include <stdlib.h>

struct estimating *
pool_find_estimate_locked(const struct pool *p)
{
    struct estimating *e = p->estimates;

    while (e && !estimate_open(e->estimate))
        e = e->next;
    return e;
}

bool
pool_is_estimating_locked(const struct pool *p)
{
    const struct estimating *e = p->estimates;

    while (e && e->members == 0)
        e = e->next;
    return e != NULL;
}

/* No thread is at the estimate any more: hand it to the loop. */
static void
end_estimate_locked(struct pool *p, struct estimating *e)
{
    struct estimating **at = &p->estimates;

    while (*at != e)
        at = &(*at)->next;
    *at = e->next;
    e->wall_s = pool_seconds(CLOCK_MONOTONIC) - e->wall0;
    e->next = p->estimated;
    p->estimated = e;
    wake_send(&p->wake);
}

void
pool_work_on_estimate(struct renderer *by, struct estimating *e)
{
    struct pool *p = by->pool;
    struct pool_stint stint = pool_stint_begin(by);
    double cpu;

    estimate_work(e->estimate, &by->ctx, &p->stopping);
    cpu = pool_stint_end_and_lock(by, &stint);
    estimate_count(e->estimate, &by->ctx.counts, cpu);
    if (--e->members == 0 && !estimate_open(e->estimate))
        end_estimate_locked(p, e);
    uv_mutex_unlock(&p->mu);
}

void
pool_give_estimates(struct pool *p)
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
    e->wall0 = pool_seconds(CLOCK_MONOTONIC);
    uv_mutex_lock(&p->mu);
    e->next = p->estimates;
    p->estimates = e;
    if (estimate_open(estimate))
        uv_cond_broadcast(&p->work);
    else
        end_estimate_locked(p, e); /* it has no areas */
    uv_mutex_unlock(&p->mu);
    return true;
}

void
pool_free_estimates(struct estimating *e)
{
    while (e) {
        struct estimating *next = e->next;

        estimate_free(e->estimate);
        free(e);
        e = next;
    }
}
