/* eta.c - see eta.h
 *
 * With N the rays that were foreseen, r those that came and d the share of the
 * picture that is there, N - r and r (1 - d)/d are left; the geometric mean of
 * these is taken, with the weight d^2/(d^2 + 1/2) for the second: at a tenth of
 * the picture it counts for a fiftieth, at half of it for a third.
 * Fitted to rooms of -ab 2 to 5 with one and two workers (tests/check_eta.c has
 * their reports): the second is 15 times too long when a seventieth is there,
 * and 2 times at two thirds.
 * In a job with passes the second is right within a factor of 1.6 from the
 * first tenth on: then its weight is d^2/(d^2 + 1/50), a half at 14 hundredths.
 */
#include "config.h"

#include "trial/eta.h"

#include <math.h>

/* The pace is a mean that forgets: workers come and go, and share themselves
 * with other jobs.  Reports tell of rays in lumps. */
static const double LEAST_MEMORY_S = 5, MOST_MEMORY_S = 60;

/* of the picture, and of time, before its share tells anything by itself: it
 * may be that it begins with sky */
static const double ENOUGH = .1, ENOUGH_S = 3;

/* While a trial is under way that will know better. */
static const double ENOUGH_AWAITED = .3;

/* of the share, as said above */
static const double DOUBT = .5, EVEN_DOUBT = .02;

/* What is left at least, in rays that came: a trial may have foreseen too
 * little. */
static const double LEAST_LEFT = .2;

static void
take_pace(struct eta *e, const struct eta_look *look)
{
    double dt = look->elapsed_s - e->last_s, memory_s, keep;

    if (look->rays < e->last_rays || dt < 0) { /* the job began again */
        *e = (struct eta){ .foreseen = e->foreseen,
                           .awaited = e->awaited,
                           .even = e->even };
        dt = look->elapsed_s;
    }
    if (look->working && dt > 0 && look->rays > 0) {
        /* the longer it goes on, the steadier is what is known of it */
        e->work_s += dt;
        memory_s = fmin(fmax(e->work_s / 2, LEAST_MEMORY_S), MOST_MEMORY_S);
        /* at first this is the mean of all that came */
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
        return d >= (e->awaited && !e->even ? ENOUGH_AWAITED : ENOUGH) &&
                       e->work_s >= ENOUGH_S
                   ? by_share
                   : -1;
    left =
        fmax(e->foreseen - e->last_rays, LEAST_LEFT * e->last_rays * (1 - d)) /
        e->rate;
    if (d == 0) /* nothing tells yet whether the trial is right */
        return left;
    weight = d * d / (d * d + (e->even ? EVEN_DOUBT : DOUBT));
    return exp((1 - weight) * log(left) + weight * log(by_share));
}

void
eta_foresee(struct eta *e, double rays)
{
    e->foreseen = rays;
    e->awaited = true;
}
