/* calclamp.c - library functions for measured luminaires
 *
 * source_corr(v, kind) turns an intensity that was measured from afar into the
 * radiance of the surface that stands for the luminaire: A1, the multiplier,
 * times v over the area that is seen.  kind 0 makes no correction; 1 is a flat
 * luminaire, by the cosine; 2 a box of A2 by A3 by A4; 3 the same seen from
 * near; 4 an upright cylinder of diameter A2 and height A3.  source_theta(180)
 * and source_phi(period) are the angles [degree] of the light's direction from
 * the nadir and about it, folded if the distribution repeats after less than
 * 360 degrees.
 * A single real argument is the multiplier, as the library's source.cal says,
 * although Radiance 6 then uses none.
 * Source: source.cal of Radiance's library, which calls these functions. */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <math.h>

#include "arith/elementary.h"

#define DEGREES (180 / M_PI)

/* Indices of the multiplier and the sizes among the real arguments. */
enum { A1, A2, A3, A4 };

/* Channels: see calcinit.c. */
enum { D = 0, P = 6, RDOT = 10, TS = 24 };

/* The area of a box that is seen.  From near these are the sides seen from
 * P - D Ts, in coordinates with the box's middle as origin. */
static double
box(const double *c, const double *size, bool near)
{
    double sum = 0;

    for (int i = 0; i < 3; i++) {
        double side = size[(i + 1) % 3] * size[(i + 2) % 3];
        double beyond = fabs(c[P + i] - c[D + i] * c[TS]) - size[i] / 2;

        sum += near ? fmax(beyond, 0) * side / c[TS] : fabs(c[D + i]) * side;
    }
    return sum;
}

static double
drum(const double *c, const double *size)
{
    double down = c[D + 2] >= 1 ? 1 - 1e-6 : c[D + 2]; /* never 0 */

    return size[0] * size[1] * sqrt(fmax(1 - down * down, 0)) +
           M_PI / 4 * size[0] * size[0] * fabs(down);
}

static double
correct(double v, int kind, const struct rad_calc_input *in,
        enum rad_calc_fault *fault)
{
    static const int needed[] = { 0, 0, 4, 4, 3 };
    const double *c = in->channel, *a = in->args;

    if (in->nargs > 0)
        v *= a[A1];
    if (!(v > 0))
        return 0;
    if (kind < 0 || kind > 4 || in->nargs < needed[kind]) {
        *fault = RAD_CALC_NO_ARG;
        return 0;
    }
    switch (kind) {
    case 1:
        return v / c[RDOT];
    case 2:
    case 3:
        return v / box(c, a + A2, kind == 3);
    case 4:
        return v / drum(c, a + A2);
    default:
        return v;
    }
}

static double
azimuth(const double *c, double period, enum rad_calc_fault *fault)
{
    double phi = rad_atan2(-c[D + 1], -c[D]) * DEGREES;

    if (phi < 0)
        phi += 360;
    switch ((int)fmin(fmax(period + .5, 0), 1000)) {
    case 90:
        phi -= phi >= 180 ? 180 : 0;
        return phi < 90 ? phi : 180 - phi;
    case 180:
        return phi < 180 ? phi : 360 - phi;
    case 360:
        return phi;
    default:
        *fault = RAD_CALC_NO_ARG;
        return 0;
    }
}

double
rad_calc_luminaire(enum luminaire which, const double *v,
                   const struct rad_calc_input *in, enum rad_calc_fault *fault)
{
    if (!in || !in->channel || !in->args) {
        *fault = RAD_CALC_NO_CHANNEL;
        return 0;
    }
    switch (which) {
    case LUMINAIRE_CORR:
        return correct(v[0], (int)fmin(fmax(v[1] + .5, -1), 1000), in, fault);
    case LUMINAIRE_THETA:
        return rad_acos(fmin(fmax(in->channel[D + 2], -1), 1)) * DEGREES;
    default:
        return azimuth(in->channel, v[0], fault);
    }
}
