/* host_time.c - what a host does at any time, and what it did in all */
#include "config.h"

#include "host_impl.h"

#include <math.h>
#include <stdio.h>

void
host_time_wait(struct host *h)
{
    bool waits = !h->working && strict_waits(h->strict);

    if (waits && h->idle_us == 0)
        h->idle_us = h->cluster->now_us;
    if (!waits && h->idle_us != 0) {
        h->wait_s += 1e-6 * (double)(h->cluster->now_us - h->idle_us);
        h->idle_us = 0;
    }
}

enum host_state
host_time_state(const struct host *h)
{
    const struct strict_pass *p = h->task.pass;

    if (!h->ready)
        return HOST_LOADS;
    if (h->at_tiles != HOST_STATES)
        return h->at_tiles;
    if (host_tiles_open(h))
        return HOST_BARRIER;
    if (h->working)
        return p && !strict_has_true_top(p) && !p->spec.loan ? HOST_AHEAD
                                                             : HOST_TRUTH;
    return strict_waits(h->strict) ? HOST_WAITS : HOST_EMPTY;
}

void
host_time_tell(const struct host *h, const char *what)
{
    const struct strict_pass *p = h->task.pass;

    if (!h->cluster->spec->verbose)
        return;
    printf("%10.6f %s %s", 1e-6 * (double)h->cluster->now_us, h->name, what);
    if (p)
        printf(" unit=%u attempt=%u mode=%d lines=%d-%d%s", p->unit, p->attempt,
               (int)p->spec.mode, p->spec.first, p->spec.last,
               p->spec.loan ? " loan" : "");
    puts("");
}

/* It was in that state from state_us to then [us]. */
static void
book(struct host *h, enum host_state state, uint64_t until_us)
{
    const struct cluster *c = h->cluster;
    double slice_us = 1e6 * c->out->work / c->out->speed / CLUSTER_SLICES_IDEAL;
    double at = (double)h->state_us - (double)c->start_us;
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
    h->state_us = until_us;
}

void
host_time_note(struct host *h, enum host_state next)
{
    static const char *const name[HOST_STATES] = {
        "loads", "truth", "ahead",   "waits",   "empty",
        "tiles", "walks", "inserts", "barrier", "records"
    };
    const struct cluster *c = h->cluster;
    enum host_state state = h->state;

    if (state == HOST_BARRIER && host_tiles_open(h) &&
        c->closed_us[h->passes] > 0) {
        if (c->closed_us[h->passes] > h->state_us)
            book(h, state, c->closed_us[h->passes]);
        state = HOST_RECORDS;
    }
    book(h, state, c->now_us);
    host_time_tell(h, name[next]);
    h->state = next;
}

void
host_over(struct host *h)
{
    host_time_note(h, h->state);
}

void
host_count(const struct host *h, struct cluster_result *out)
{
    out->busy_s += h->busy_s;
    if (h->wait_s > out->wait_s)
        out->wait_s = h->wait_s;
    out->twice_s += h->twice_s;
    out->units += h->units;
    out->traced += h->traced;
}
