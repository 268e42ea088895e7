/* human.c - see human.h
 *
 * Steps and constants are those of the paper and of pcond(1), whose results
 * tests compare. */
#include "config.h"

#include "tone/human.h"

#include <math.h>
#include <string.h>

#define MOST_OF_WORLD 1e7  /* [cd/m^2] */
#define TRIMMED       .025 /* share of samples that may remain to be trimmed */

/* --- formulas --- */

double
rad_human_threshold(double La)
{
    double l;

    if (La < 1.148e-4)
        return 1.38e-3;
    l = log10(La);
    if (l < -1.44) /* rods */
        return pow(10, pow(.405 * l + 1.6, 2.18) - 2.86);
    if (l < -.0184)
        return pow(10, l - .395);
    if (l < 1.9) /* cones */
        return pow(10, pow(.249 * l + .65, 2.7) - .72);
    return pow(10, l - 1.255);
}

double
rad_human_acuity(double La)
{
    return 17.25 * atan(1.4 * log10(fmax(La, RAD_HUMAN_LEAST)) + .35) + 25.72;
}

/* --- the tone curve --- */

void
rad_human_linear(struct rad_human *h, double scale)
{
    h->linear = true;
    h->scale = scale;
}

static double
display_range(void)
{
    return log(RAD_HUMAN_BRIGHTEST / RAD_HUMAN_DARKEST);
}

double
rad_human_display(const struct rad_human *h, double Lw)
{
    double x, share;
    int i;

    if (!(Lw > RAD_HUMAN_LEAST))
        return RAD_HUMAN_DARKEST;
    x = RAD_HUMAN_BINS * (log(Lw) - h->bmin) / (h->bmax - h->bmin);
    if (x <= 0)
        return RAD_HUMAN_DARKEST;
    if (x >= RAD_HUMAN_BINS)
        return RAD_HUMAN_BRIGHTEST;
    i = (int)x;
    x -= i;
    share = h->below[i] * (1 - x) + h->below[i + 1] * x;
    return RAD_HUMAN_DARKEST * exp(share * display_range());
}

static double
sum_of_bins(const double bin[RAD_HUMAN_BINS])
{
    double sum = 0;

    for (int i = 0; i < RAD_HUMAN_BINS; i++)
        sum += bin[i];
    return sum;
}

static void
accumulate(struct rad_human *h, const double bin[RAD_HUMAN_BINS])
{
    double total = sum_of_bins(bin), sum = 0;

    for (int i = 0; i < RAD_HUMAN_BINS; i++) {
        h->below[i] = sum / total;
        sum += bin[i];
    }
    h->below[RAD_HUMAN_BINS] = 1;
}

/* The most samples that a bin at luminance Lw may have, of `total`, so that the
 * curve does not exceed visible contrast: the relative step of the screen over
 * that of the world must be at most the ratio of the thresholds. */
static double
most_in_bin(const struct rad_human *h, double Lw, double total)
{
    double step = (h->bmax - h->bmin) / RAD_HUMAN_BINS;
    double Ld = rad_human_display(h, Lw);
    double ratio = rad_human_threshold(Ld) / rad_human_threshold(Lw);

    return total * step * ratio * Lw / (Ld * display_range());
}

/* Trim bins until the curve satisfies this; false: nothing is left, because the
 * screen can show all contrasts. */
static bool
trim(struct rad_human *h, const struct rad_histogram *world)
{
    double bin[RAD_HUMAN_BINS], total, trimmed;
    double step = (h->bmax - h->bmin) / RAD_HUMAN_BINS;

    memcpy(bin, world->bin, sizeof bin);
    do {
        total = sum_of_bins(bin);
        if (total <= TRIMMED * world->total)
            return false;
        accumulate(h, bin);
        trimmed = 0;
        for (int i = 0; i < RAD_HUMAN_BINS; i++) {
            double most = most_in_bin(h, exp(h->bmin + (i + .5) * step), total);

            if (bin[i] > most) {
                trimmed += bin[i] - most;
                bin[i] = most;
            }
        }
    } while (trimmed > TRIMMED * total);
    return true;
}

/* --- adaptation --- */

bool
rad_human_range(struct rad_human *h, double least, double most)
{
    memset(h, 0, sizeof *h);
    most = fmin(1.01 * most, MOST_OF_WORLD);
    if (!(most > RAD_HUMAN_LEAST))
        return false;
    h->bmax = log(most);
    h->bmin = log(RAD_HUMAN_LEAST);
    h->spare = least >= RAD_HUMAN_LEAST;
    if (h->spare)
        h->bmin = h->bmax - (h->bmax - log(least)) * RAD_HUMAN_BINS /
                                (RAD_HUMAN_BINS - 1);
    return true;
}

void
rad_human_count(const struct rad_human *h, struct rad_histogram *w, double Lw,
                double weight)
{
    double b, x;

    if (!(Lw >= RAD_HUMAN_LEAST))
        return;
    b = log(Lw);
    x = RAD_HUMAN_BINS * (b - h->bmin) / (h->bmax - h->bmin);
    if (!(x >= 0 && x < RAD_HUMAN_BINS))
        return;
    w->bin[(int)x] += weight;
    w->logs += weight * b;
    w->total += weight;
}

double
rad_human_darkest(const struct rad_human *h, const struct rad_histogram *w,
                  double share)
{
    double left = share * w->total;
    int i = 0;

    while (i < RAD_HUMAN_BINS - 1 && (left -= w->bin[i]) > 0)
        i++;
    return exp(h->bmin + (i + .5) * (h->bmax - h->bmin) / RAD_HUMAN_BINS);
}

bool
rad_human_fits(const struct rad_human *h)
{
    return h->bmax - h->bmin <= display_range();
}

/* The factor if all contrasts fit: it maps the threshold at the mean luminance
 * to the threshold at the middle of the screen's range. */
static double
linear_scale(double mean)
{
    double middle = sqrt(RAD_HUMAN_DARKEST * RAD_HUMAN_BRIGHTEST);

    return rad_human_threshold(middle) / rad_human_threshold(exp(mean)) *
           RAD_HUMAN_EFFICACY / RAD_HUMAN_BRIGHTEST;
}

void
rad_human_adapt(struct rad_human *h, const struct rad_histogram *w, bool fits)
{
    struct rad_histogram world = *w;

    if (h->spare) { /* give it half of the lowest bin in use */
        world.bin[1] *= .5;
        world.bin[0] += world.bin[1];
    }
    if (fits || !trim(h, &world))
        rad_human_linear(h, linear_scale(w->logs / w->total));
}
