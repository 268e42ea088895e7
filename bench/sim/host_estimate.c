/* host_estimate.c - estimates: what random pixels of areas would cost */
#include "config.h"

#include "host_impl.h"

#include <math.h>
#include <stdlib.h>

/* A pixel's cost has about its mean as standard deviation. */
#define SPREAD 1.0

static void
estimate_done(void *arg, struct event *e)
{
    struct host *h = host_alive(arg, e);
    struct msg m = { .type = MSG_ESTIMATED };
    struct asked *a;

    if (!h)
        return;
    h->working = false;
    a = h->asked;
    h->asked = a->next;
    m.estimated = (struct msg_estimated){ .job = h->cluster->job,
                                          .id = a->id,
                                          .ncosts = a->n,
                                          .costs = a->costs,
                                          .counts = host_counts(
                                              h, a->seconds, a->seconds, 0) };
    host_say(h, &m);
    free(a->costs);
    free(a);
    host_go_on(h);
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
host_estimate_take(struct host *h, const struct msg_estimate *m)
{
    struct asked *a = sim_alloc(sizeof *a), **at = &h->asked;

    a->id = m->id;
    a->n = m->nareas;
    a->costs = sim_alloc(m->nareas * sizeof *a->costs);
    for (uint32_t i = 0; i < m->nareas; i++) {
        double cost = sampled(h, &m->areas[i], m->rays);

        a->costs[i].rays = (uint64_t)(cost * RAYS_PER_S);
        a->costs[i].tests = (uint64_t)(3 * cost * RAYS_PER_S);
        a->seconds += cost / h->speed;
    }
    while (*at)
        at = &(*at)->next;
    *at = a;
}

void
host_estimate_begin(struct host *h)
{
    host_spend(h, h->asked->seconds, estimate_done);
}

void
host_estimate_forget(struct host *h)
{
    while (h->asked) {
        struct asked *a = h->asked;

        h->asked = a->next;
        free(a->costs);
        free(a);
    }
}
