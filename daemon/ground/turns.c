/* turns.c - see turns.h
 *
 * libuv tells how long it has waited (UV_METRICS_IDLE_TIME); the rest of the
 * time from one wait to the next is the turn's. */
#include "config.h"

#include "ground/turns.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

static uint64_t
thread_ns(void)
{
    struct timespec t;

    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t) != 0)
        return 0;
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static void
look(struct turns *t)
{
    t->wall_ns = uv_hrtime();
    t->idle_ns = uv_metrics_idle_time(t->before.loop);
    t->cpu_ns = thread_ns();
    t->what = "";
    t->what_ns = 0;
}

static void
log_slow(struct turns *t, double ms, double cpu_ms)
{
    unsigned dropped = 0;

    if (!log_allowed(&t->limit, uv_now(t->before.loop), &dropped))
        return;
    if (dropped > 0)
        log_warn("slow turns not logged n=%u", dropped);
    log_warn("slow turn ms=%.0f cpu_ms=%.0f what=%s what_ms=%.0f", ms, cpu_ms,
             t->what, (double)t->what_ns / 1e6);
}

static void
count(struct turns *t, double ms, double cpu_ms)
{
    struct turns_seen *s = &t->seen;

    if (ms > s->longest_ms)
        s->longest_ms = ms;
    if (cpu_ms > s->longest_cpu_ms)
        s->longest_cpu_ms = cpu_ms;
    if (cpu_ms < TURNS_LONG_MS && ms < TURNS_STALLED_MS)
        return;
    s->slow++;
    log_slow(t, ms, cpu_ms);
}

static void
turn_over(uv_prepare_t *h)
{
    struct turns *t = h->data;
    uint64_t wall = uv_hrtime() - t->wall_ns;
    uint64_t idle = uv_metrics_idle_time(h->loop) - t->idle_ns;
    uint64_t cpu = thread_ns() - t->cpu_ns;

    count(t, wall > idle ? (double)(wall - idle) / 1e6 : 0, (double)cpu / 1e6);
    look(t);
}

void
turns_start(struct turns *t, uv_loop_t *loop)
{
    memset(t, 0, sizeof *t);
    uv_loop_configure(loop, UV_METRICS_IDLE_TIME);
    uv_prepare_init(loop, &t->before);
    t->before.data = t;
    uv_prepare_start(&t->before, turn_over);
    look(t);
}

void
turns_stop(struct turns *t)
{
    if (t->before.loop) /* turns_start() was called */
        uv_close((uv_handle_t *)&t->before, NULL);
}

void
turns_note(struct turns *t, const char *what, uint64_t ns)
{
    if (ns <= t->what_ns)
        return;
    t->what = what;
    t->what_ns = ns;
}
