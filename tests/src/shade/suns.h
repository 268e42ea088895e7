/* suns.h - small suns as light from a given direction, for tests
 *
 * A material's BRDF shows in the radiance of a square under one sun, its
 * integral under many. */
#ifndef RADD_TESTS_SUNS_H
#define RADD_TESTS_SUNS_H

#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SUN_DEG .01

/* Radiance of a sun that gives E on what faces it. */
static inline double
sun_radiance(double E)
{
    return E / (2 * M_PI * (1 - cos(SUN_DEG * M_PI / 360)));
}

/* Append a sun in direction dir. */
static inline void
add_sun(char *text, size_t size, const double dir[3], double E)
{
    size_t at = strlen(text);
    double L = sun_radiance(E);

    at += (size_t)snprintf(text + at, size - at,
                           "void light sun 0 0 3 %.9g %.9g %.9g\n"
                           "sun source s 0 0 4 %.15g %.15g %.15g %g\n",
                           L, L, L, dir[0], dir[1], dir[2], SUN_DEG);
    ck_assert_uint_lt(at, size);
}

/* Append suns spread evenly (a Fibonacci spiral) over the half space of sign z,
 * which together are as bright as a sky of radiance 1. */
static inline void
add_suns(char *text, size_t size, double z)
{
    enum { N = 3000 };
    double L = sun_radiance(2 * M_PI / N);
    size_t at = strlen(text);

    at += (size_t)snprintf(text + at, size - at,
                           "void light sun 0 0 3 %.9g %.9g %.9g\n", L, L, L);
    for (int i = 0; i < N && at < size; i++) {
        double c = (i + .5) / N, s = sqrt(1 - c * c), phi = i * 2.39996322973;

        at += (size_t)snprintf(text + at, size - at,
                               "sun source s 0 0 4 %.9g %.9g %.9g %g\n",
                               s * cos(phi), s * sin(phi), z * c, SUN_DEG);
    }
    ck_assert_uint_lt(at, size);
}

#endif
