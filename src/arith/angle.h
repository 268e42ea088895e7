/* angle.h - angles, sines and cosines for inner loops
 *
 * Inner loops of indirect light need only these ranges.  A call to libm takes
 * several times as long, and its result may differ from machine to machine;
 * these functions use only sums, products and quotients.
 * The polynomials interpolate at the Chebyshev nodes of their range and were
 * computed with 60 digits.  Their own error is below 2^-55 of the result, so
 * rounding is all that counts. */
#ifndef RAD_ARITH_ANGLE_H
#define RAD_ARITH_ANGLE_H

#include <math.h>

/* Arc tangent of t, |t| <= tan(pi / 8). */
static inline double
rad_arc(double t)
{
    const double z = t * t, z2 = z * z, z4 = z2 * z2;
    double a = -0.3333333333333333 + 0.19999999999995516 * z;
    double b = -0.14285714284665682 + 0.11111111015187018 * z;
    double c = -0.0909090457530649 + 0.07692183125376892 * z;
    double d = -0.06664510525508936 + 0.05858140904866328 * z;
    double e = -0.050854078345894844 + 0.03923044778479309 * z;
    double f = -0.019175404711104935;

    /* sums in pairs, so that few additions wait for each other */
    return t + t * z * ((a + b * z2) + ((c + d * z2) + (e + f * z2) * z4) * z4);
}

/* The angle of (x, y), y >= 0, from the x axis: in [0, pi], with a relative
 * error of at most 2^-51.  For arguments that are not finite it may be
 * anything. */
static inline double
rad_angle(double y, double x)
{
    const double eighth = 0.41421356237309503; /* tan(pi / 8) */
    double ax = fabs(x), lo, hi, turn;

    if (y <= eighth * x)
        return x > 0 ? rad_arc(y / x) : 0;
    lo = y < ax ? y : ax;
    hi = y < ax ? ax : y;
    turn = lo > eighth * hi ? M_PI / 4 + rad_arc((lo - hi) / (lo + hi))
                            : rad_arc(lo / hi);
    if (y > ax)
        turn = M_PI / 2 - turn;
    return x < 0 ? M_PI - turn : turn;
}

/* Sine and cosine of an angle in [-pi / 4, pi / 4]. */
static inline void
rad_sin_cos(double angle, double *sine, double *cosine)
{
    const double z = angle * angle, z2 = z * z, z4 = z2 * z2;
    double a = -0.16666666666666666 + 0.008333333333330948 * z;
    double b = -0.00019841269836758574 + 2.755731610255244e-06 * z;
    double c = -2.5051131845003624e-08 + 1.5918129294866608e-10 * z;
    double d = 0.041666666666666664 - 0.0013888888888887398 * z;
    double e = 2.480158729876569e-05 - 2.7557317271729793e-07 * z;
    double f = 2.08761462684032e-09 - 1.1382632425521717e-11 * z;

    *sine = angle + angle * z * (a + b * z2 + c * z4);
    *cosine = 1 - z / 2 + z2 * (d + e * z2 + f * z4);
}

#endif
