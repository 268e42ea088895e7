/* contrast.c - see contrast.h */
#include "config.h"

#include "light/sample/contrast.h"
#include "base/vec.h"

#include <math.h>

/* over[n + 1] is 1 / n, or 0 if n is not positive.  What needs it is computed
 * nine times for each cell, and a division would take as long as all the rest.
 */
static const double over[10] = { 0,      0,      1,      1. / 2, 1. / 3,
                                 1. / 4, 1. / 5, 1. / 6, 1. / 7, 1. / 8 };

/* The deviation expected of a cell, by its `square`, and by the sums over the
 * cells around it and the inverse of their number. */
static double
expected(double square, double inverse, double sum, double sum2)
{
    double mean = sum * inverse;

    return sqrt(square + rad_most(sum2 * inverse - mean * mean, 0));
}

/* Sum up the luminances of the `around` cells around *c, in rows of `wide`
 * cells.  Those of the border are 0. */
static void
look_around(struct rad_contrast *c, int wide, int around)
{
    const struct rad_contrast *up = c - wide, *down = c + wide;

    c->sum = up[-1].lum + up[0].lum + up[1].lum + c[-1].lum + c[1].lum +
             down[-1].lum + down[0].lum + down[1].lum;
    c->sum2 = up[-1].lum * up[-1].lum + up[0].lum * up[0].lum +
              up[1].lum * up[1].lum + c[-1].lum * c[-1].lum +
              c[1].lum * c[1].lum + down[-1].lum * down[-1].lum +
              down[0].lum * down[0].lum + down[1].lum * down[1].lum;
    c->less = over[around];
    c->noise = expected(c->square, over[around + 1], c->sum, c->sum2);
}

/* By how much the sample of a cell beside *c, of luminance lum, raises the
 * deviation expected of *c; 0 if *c is of the border. */
static inline double
raised(const struct rad_contrast *c, double lum, double lum2)
{
    return c->noise -
           expected(c->square, c->less, c->sum - lum, c->sum2 - lum2);
}

/* By how much *c's sample raises the deviations expected of the cells around
 * it, in all. */
static double
own_part(const struct rad_contrast *c, int wide)
{
    const struct rad_contrast *up = c - wide, *down = c + wide;
    double lum = c->lum, lum2 = lum * lum;

    return raised(up - 1, lum, lum2) + raised(up, lum, lum2) +
           raised(up + 1, lum, lum2) + raised(c - 1, lum, lum2) +
           raised(c + 1, lum, lum2) + raised(down - 1, lum, lum2) +
           raised(down, lum, lum2) + raised(down + 1, lum, lum2);
}

/* Of how many rows, or columns, are cell i and the cells beside it? */
static int
beside(int i, int n)
{
    return 1 + (i > 0) + (i < n - 1);
}

void
rad_contrast_share(struct rad_contrast *cell, int n)
{
    double all = 0;

    for (int k = 0; k < n * n; k++) {
        struct rad_contrast *c = &cell[rad_contrast_at(k, n)];

        look_around(c, n + 2, beside(k / n, n) * beside(k % n, n) - 1);
        all += c->noise;
    }
    if (!(all > 0 && all < INFINITY))
        return;
    for (int k = 0; k < n * n; k++) {
        struct rad_contrast *c = &cell[rad_contrast_at(k, n)];

        if (c->noise > 0)
            c->share = c->noise / rad_most(all - own_part(c, n + 2), c->noise);
    }
}
