/* lambert.h - the irradiance of a polygon, and of a disk, for tests */
#ifndef RADD_TESTS_LAMBERT_H
#define RADD_TESTS_LAMBERT_H

#include "base/vec.h"

#include <math.h>

/* Irradiance per radiance at p with unit normal n from a polygon that is
 * wholly above the horizon; negative where it shows p its back. */
static inline double
lambert(const double *v, int nv, const double p[3], const double n[3])
{
    double E = 0;

    for (int i = 0; i < nv; i++) {
        double a[3], b[3], c[3];

        rad_sub(a, v + 3 * i, p);
        rad_sub(b, v + 3 * ((i + 1) % nv), p);
        rad_cross(c, b, a);
        double sine = rad_normalize(c), cosine = rad_dot(a, b);

        E += atan2(sine, cosine) * rad_dot(c, n) / 2;
    }
    return E;
}

/* Irradiance per radiance of a disk of radius r that faces the plane at height
 * h, its centre x aside of the zenith (Foote 1915, Scientific Papers of the
 * Bureau of Standards 263). */
static inline double
lambert_disk(double r, double x, double h)
{
    double z = h * h + x * x + r * r;

    return M_PI / 2 * (1 - (z - 2 * r * r) / sqrt(z * z - 4 * x * x * r * r));
}

#endif
