/* host_time.c - what a host does at any time, and what it did in all */
#include "config.h"

#include "host_impl.h"

#include <math.h>
#include <stdio.h>

static int
count_idle(const struct host *h)
{
    int n = 0;

    for (int i = 0; i < h->cluster->spec->threads; i++)
        n += !h->thread[i].working && !h->thread[i].pass;
    return n;
}

void
host_time_wait(struct host *h)
{
    uint64_t now = h->cluster->now_us;

    h->wait_s += 1e-6 * h->idle * (double)(now - h->idle_us);
    h->idle = strict_waits(h->strict) ? count_idle(h) : 0;
    h->idle_us = now;
}

static enum host_state
state_of(const struct host_thread *t)
{
    const struct host *h = t->host;

    if (!h->ready)
        return HOST_LOADS;
    if (t->at_tiles != HOST_STATES)
        return t->at_tiles;
    if (t->waits)
        return HOST_BELOW;
    if (t->pass)
        return host_pass_state(t->pass);
    if (t->working)
        return HOST_TRUTH;
    if (host_tiles_change(h))
        return HOST_CHANGES;
    if (host_tiles_open(h))
        return HOST_BARRIER;
    return strict_waits(h->strict) ? HOST_WAITS : HOST_EMPTY;
}

void
host_time_tell(const struct host_thread *t, const char *what)
{
    const struct host *h = t->host;

    if (!h->cluster->spec->verbose)
        return;
    printf("%10.6f %s.%d %s", 1e-6 * (double)h->cluster->now_us, h->name,
           (int)(t - h->thread), what);
    if (t->pass)
        host_pass_tell(t->pass);
    puts("");
}

/* It was in that state from state_us to then [us]. */
static void
book(struct host_thread *t, enum host_state state, uint64_t until_us)
{
    const struct cluster *c = t->host->cluster;
    double slice_us = 1e6 * c->out->work / c->out->speed / CLUSTER_SLICES_IDEAL;
    double at = (double)t->state_us - (double)c->start_us;
    double end = (double)until_us - (double)c->start_us;

    if (at < 0)
        at = 0;
    while (at < end) {
        int k = (int)(at / slice_us);
        double to = fmin(end, (k + 1) * slice_us);

        if (k >= CLUSTER_SLICES)
            k = CLUSTER_SLICES - 1;
        if (to <= at)
            to = end;
        c->out->state_s[k][state] += 1e-6 * (to - at);
        at = to;
    }
    t->state_us = until_us;
}

void
host_time_note(struct host_thread *t)
{
    static const char *const name[HOST_STATES] = {
        "loads", "truth", "ahead",   "waits",   "below",   "empty",
        "tiles", "walks", "inserts", "changes", "barrier", "records"
    };
    const struct host *h = t->host;
    const struct cluster *c = h->cluster;
    enum host_state state = t->state, next = state_of(t);

    if (state == HOST_BARRIER && host_tiles_open(h) &&
        c->closed_us[h->closed] > 0) {
        if (c->closed_us[h->closed] > t->state_us)
            book(t, state, c->closed_us[h->closed]);
        state = HOST_RECORDS;
    }
    book(t, state, c->now_us);
    t->state = next;
    if (state != next)
        host_time_tell(t, name[next]);
}

void
host_time_look(struct host *h)
{
    for (int i = 0; i < h->cluster->spec->threads; i++)
        if (state_of(&h->thread[i]) != h->thread[i].state)
            host_time_note(&h->thread[i]);
}

void
host_over(struct host *h)
{
    for (int i = 0; i < h->cluster->spec->threads; i++)
        host_time_note(&h->thread[i]);
}

void
host_count(const struct host *h, struct cluster_result *out)
{
    double wait_s = h->wait_s / h->cluster->spec->threads;

    out->busy_s += h->busy_s;
    if (wait_s > out->wait_s)
        out->wait_s = wait_s;
    out->twice_s += h->twice_s;
    out->units += h->units;
    out->traced += h->traced;
}
