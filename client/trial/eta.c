/* eta.c - see eta.h
 *
 * Let N be the rays that were foreseen, r those that came and d the share of
 * the picture that is done.  By the trial N - r rays are left, by the share
 * r (1 - d)/d.  The result is the geometric mean of both, with the weight
 * d^2/(d^2 + 1/2) for the second: 1/50 when a tenth of the picture is done, 1/3
 * at half of it.
 * This was fitted to rooms of -ab 2 to 5 with one and two workers, whose
 * reports are in tests/client/check_eta.c: there the second number is 15 times
 * too large when a seventieth is done, and still twice too large at two thirds.
 * In a job with passes it is right within a factor of 1.6 from the first tenth
 * on. */
#include "config.h"

#include "trial/eta.h"

#include <math.h>

/* Limits of the time constant of the pace, a mean that forgets: workers come
 * and go and also work on other jobs, and reports tell of rays in lumps. */
static const double LEAST_MEMORY_S = 5, MOST_MEMORY_S = 60;

/* How much of the picture, and of working time, must be done before the share
 * alone gives a result: a picture may begin with sky. */
static const double ENOUGH = .1, ENOUGH_S = 3;

/* The same share while a trial runs, whose result will be better. */
static const double ENOUGH_AWAITED = .3;

/* The constant of the weight at the head of this file. */
static const double DOUBT = .5;

/* At least so many of the rays that came are left, times 1 - d: a trial may
 * have foreseen too few. */
static const double LEAST_LEFT = .2;

static void
take_pace(struct eta *e, const struct eta_look *look)
{
    double dt = look->elapsed_s - e->last_s, memory_s, keep;

    if (look->rays < e->last_rays || dt < 0) { /* the job began again */
        *e = (struct eta){ .foreseen = e->foreseen, .awaited = e->awaited };
        dt = look->elapsed_s;
    }
    if (look->working && dt > 0 && look->rays > 0) {
        /* the longer the job has run the steadier the pace is */
        e->work_s += dt;
        memory_s = fmin(fmax(e->work_s / 2, LEAST_MEMORY_S), MOST_MEMORY_S);
        /* as long as dt / work_s is larger, the rate is the mean of all reports
         */
        keep = 1 - fmax(dt / e->work_s, 1 - exp(-dt / memory_s));
        e->rate =
            keep * e->rate + (1 - keep) * (look->rays - e->last_rays) / dt;
    }
    e->last_s = look->elapsed_s;
    e->last_rays = look->rays;
}

double
eta_by_share(const struct eta *e, double done)
{
    if (!(e->rate > 0) || !(done > 0))
        return INFINITY;
    return e->last_rays * (1 - done) / done / e->rate;
}

double
eta_take(struct eta *e, const struct eta_look *look)
{
    double by_share, left, d = fmin(fmax(look->done, 0), 1), weight;

    take_pace(e, look);
    if (d >= 1)
        return 0;
    if (!look->working || !(e->rate > 0))
        return -1;
    by_share = eta_by_share(e, d);
    if (!(e->foreseen > 0))
        return d >= (e->awaited ? ENOUGH_AWAITED : ENOUGH) &&
                       e->work_s >= ENOUGH_S
                   ? by_share
                   : -1;
    left =
        fmax(e->foreseen - e->last_rays, LEAST_LEFT * e->last_rays * (1 - d)) /
        e->rate;
    if (d == 0) /* so far nothing contradicts the trial */
        return left;
    weight = d * d / (d * d + DOUBT);
    return exp((1 - weight) * log(left) + weight * log(by_share));
}

void
eta_foresee(struct eta *e, double rays)
{
    e->foreseen = rays;
    e->awaited = true;
}
