/* host_errand.c - windows and estimates, done one after the other
 *
 * What each takes is known when it comes. */
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

static void
drop(struct errand **at)
{
    struct errand *d = *at;

    *at = d->next;
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

    host_rows_send(h, u->unit, u->attempt, u->width, 0, u->height, u->height,
                   &counts);
}

static void
done(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);

    if (!h)
        return;
    h->working = h->at_errand = false;
    if (h->errands->costs)
        send_costs(h, h->errands);
    else
        send_window(h, h->errands);
    drop(&h->errands);
    host_go_on(h);
}

bool
host_errand_begin(struct host *h)
{
    if (!h->errands)
        return false;
    h->at_errand = true;
    host_spend(h, h->errands->seconds, done);
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
    struct errand **at = &h->errands;

    if (h->at_errand)
        at = &(*at)->next; /* the first is under way */
    for (; *at; at = &(*at)->next)
        if (!(*at)->costs && (*at)->window.unit == r->unit &&
            (*at)->window.attempt == r->attempt) {
            drop(at);
            return;
        }
}

void
host_errands_forget(struct host *h)
{
    while (h->errands)
        drop(&h->errands);
    h->at_errand = false;
}
