/* doubt.c - see doubt.h
 *
 * The factors were fitted on a box and an office at night; a drafting room, a
 * room with mirrors, and the office by day were left out.  doc/measured.md has
 * what they are off by. */
#include "config.h"

#include "picture/doubt.h"

#include <math.h>

/* Differences count up to half of the mean: an edge is no noise. */
#define ROUGHEST .25

/* Records about a place also err together, or to their neighbours' side. */
#define AMBIENT_FACTOR .87

#define MOST_ERROR 1e6

void
rad_rough_row(struct rad_rough *r, const struct rad_pixel *pixels, int width,
              int row, int psample)
{
    int xstep, ystep, x;

    rad_quincunx_steps(psample, &xstep, &ystep);
    if (row % ystep != 0)
        return;
    for (x = row / ystep % 2 ? xstep / 2 : 0; x + 2 * xstep < width;
         x += xstep) {
        double a = rad_rgb_lum(pixels[x].L);
        double b = rad_rgb_lum(pixels[x + xstep].L);
        double c = rad_rgb_lum(pixels[x + 2 * xstep].L);
        double mean = (a + b + c) / 3, bend = a - 2 * b + c;

        if (!(mean > 0))
            continue;
        /* of independent values with variance v the bend has 6 v */
        r->sum += fmin(bend * bend / (6 * mean * mean), ROUGHEST);
        r->n++;
    }
}

/* Of a square that may be none. */
static double
root(double square)
{
    return fmin(sqrt(square), MOST_ERROR);
}

struct rad_error_estimate
rad_doubt_error(const struct rad_doubt *d, const struct rad_rough *r,
                int psample)
{
    struct rad_error_estimate e = { 0, 0, 0 };

    if (d->pixels > 0 && d->known > 0)
        e.ambient = AMBIENT_FACTOR *
                    root(d->variance / d->pixels * (d->all / d->known));
    /* noise falls with the samples about, and what lies between them grows
     * with their distance */
    if (r->n > 0)
        e.sampling = root(r->sum / r->n * (.06 + .0061 * psample * psample));
    e.all = root(e.ambient * e.ambient + e.sampling * e.sampling);
    return e;
}
