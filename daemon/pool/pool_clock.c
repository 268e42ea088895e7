/* pool_clock.c - elapsed time and processor time of threads */
#include "config.h"

#include "pool/pool_impl.h"

double
pool_seconds(clockid_t clock)
{
    struct timespec t;

    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

struct pool_stint
pool_stint_begin(struct renderer *by)
{
    by->ctx.counts = (struct rad_counts){ 0 };
    return (struct pool_stint){ pool_seconds(CLOCK_THREAD_CPUTIME_ID),
                                pool_seconds(CLOCK_MONOTONIC) };
}

double
pool_stint_end_and_lock(struct renderer *by, const struct pool_stint *s)
{
    double cpu = pool_seconds(CLOCK_THREAD_CPUTIME_ID) - s->cpu;
    double wall = pool_seconds(CLOCK_MONOTONIC) - s->wall;

    uv_mutex_lock(&by->pool->mu);
    by->pool->busy_s += wall;
    return cpu;
}
