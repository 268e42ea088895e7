/* host_errand.c - windows and estimates, each by one thread
 *
 * What each takes is known when it comes.  In a real child idle threads join
 * those at the last window, and at an estimate. */
#include "config.h"

#include "host_impl.h"

#include <math.h>
#include <stdlib.h>

/* A pixel's cost has about its mean as standard deviation. */
#define SPREAD 1.0

struct errand {
    struct errand *next;
    double seconds;
    struct msg_unit window;
    struct msg_cost *costs; /* of an estimate's n areas; NULL: a window */
    uint32_t id, n;
};

static struct errand *
add(struct host *h)
{
    struct errand **at = &h->errands;

    while (*at)
        at = &(*at)->next;
    return *at = sim_alloc(sizeof **at);
}

static struct errand *
take_first(struct host *h)
{
    struct errand *d = h->errands;

    if (d)
        h->errands = d->next;
    return d;
}

static void
drop(struct errand *d)
{
    if (d)
        free(d->costs);
    free(d);
}

static void
send_costs(struct host *h, const struct errand *d)
{
    struct msg m = { .type = MSG_ESTIMATED };

    m.estimated = (struct msg_estimated){ .job = h->cluster->job,
                                          .id = d->id,
                                          .ncosts = d->n,
                                          .costs = d->costs,
                                          .counts = host_counts(
                                              h, d->seconds, d->seconds, 0) };
    host_say(h, &m);
}

static void
send_window(struct host *h, const struct errand *d)
{
    const struct msg_unit *u = &d->window;
    struct msg_counts counts =
        host_counts(h, d->seconds, d->seconds, u->width * u->height / 2);

    host_rows_send(h, u, 0, u->height, &counts);
}

static void
done(void *arg, struct event *e)
{
    struct host_thread *t = host_rests(arg, e);
    struct errand *d;

    if (!t)
        return;
    d = t->errand;
    t->errand = NULL;
    if (d->costs)
        send_costs(t->host, d);
    else
        send_window(t->host, d);
    drop(d);
    host_go_on(t->host);
}

bool
host_errand_begin(struct host_thread *t)
{
    t->errand = take_first(t->host);
    if (!t->errand)
        return false;
    t->host->busy_s += t->errand->seconds;
    host_spend(t, t->errand->seconds, done);
    return true;
}

void
host_errand_window(struct host *h, const struct msg_unit *u)
{
    struct errand *d = add(h);

    d->window = *u;
    d->seconds = host_seconds(h, map_window(host_map(h), u));
}

/* A number of mean 0 and deviation 1. */
static double
gauss(struct cluster *c)
{
    double sum = 0;

    for (int i = 0; i < 12; i++)
        sum += cluster_random(c);
    return sum - 6;
}

/* What n pixels of the area cost, by chance, in seconds of speed 1. */
static double
sampled(struct host *h, const struct msg_area *a, uint32_t n)
{
    const struct map *m = host_map(h);
    uint32_t pixels = a->width * a->height;
    double mean = 0, chance;

    for (uint32_t y = a->y; y < a->y + a->height; y++)
        mean += map_row(m, a->frame, (int)y, (int)a->width);
    mean /= .5 * pixels; /* of a pixel that is traced */
    if (n > pixels)
        n = pixels;
    chance = 1 + SPREAD / sqrt(n) * gauss(h->cluster);
    return n * mean * (chance > 0 ? chance : 0);
}

void
host_errand_estimate(struct host *h, const struct msg_estimate *m)
{
    struct errand *d = add(h);

    d->id = m->id;
    d->n = m->nareas;
    d->costs = sim_alloc(m->nareas * sizeof *d->costs);
    for (uint32_t i = 0; i < m->nareas; i++) {
        double cost = sampled(h, &m->areas[i], m->rays);

        d->costs[i].rays = (uint64_t)(cost * RAYS_PER_S);
        d->costs[i].tests = (uint64_t)(3 * cost * RAYS_PER_S);
        d->seconds += cost / h->speed;
    }
}

void
host_errand_revoke(struct host *h, const struct msg_attempt *r)
{
    struct errand **at = &h->errands, *d;

    for (; (d = *at); at = &d->next)
        if (!d->costs && d->window.unit == r->unit &&
            d->window.attempt == r->attempt) {
            *at = d->next;
            drop(d);
            return;
        }
}

void
host_errands_forget(struct host *h)
{
    while (h->errands)
        drop(take_first(h));
    for (int i = 0; i < h->cluster->spec->threads; i++) {
        drop(h->thread[i].errand);
        h->thread[i].errand = NULL;
    }
}
