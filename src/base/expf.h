/* expf.h - exp() to the accuracy of a float
 *
 * What a medium lets through goes into a colour, which is float; exp() takes
 * twice as long to be right to the last bit of a double.
 * With k the integer nearest to x / ln 2 and f what is left, |f| <= 1/2, exp(x)
 * is 2^k times the Taylor series of exp(f ln 2).  Seven powers leave out less
 * than (ln 2 / 2)^8 / 8! = 5.2e-9 of it, the tenth part of what rounding to
 * float does. */
#ifndef RAD_BASE_EXPF_H
#define RAD_BASE_EXPF_H

#include <stdint.h>
#include <string.h>

typedef double rad_v2d __attribute__((vector_size(16)));
typedef uint64_t rad_v2u __attribute__((vector_size(16)));

/* For two numbers x <= 0; 0 where a float has nothing so small, and of a
 * NaN. */
static inline void
rad_expf2(double x0, double x1, float *e0, float *e1)
{
    /* added to a number it leaves it rounded to an integer, in the low bits */
    const double magic = 0x1.8p52, low = -150;
    rad_v2d x = { x0, x1 }, y = x * 1.4426950408889634, k = y + magic;
    rad_v2d f = y - (k - magic), f2 = f * f, s;
    rad_v2u bits;

    /* (ln 2)^n / n! */
    s = (1 + f * 0.6931471805599453) +
        f2 * (0.2402265069591007 + f * 0.05550410866482158) +
        f2 * f2 *
            ((0.009618129107628477 + f * 0.0013333558146428443) +
             f2 * (0.0001540353039338161 + f * 1.5252733804059841e-05));
    memcpy(&bits, &k, sizeof bits);
    bits = ((bits + 1023) << 52) & (rad_v2u)(y > low);
    memcpy(&k, &bits, sizeof k);
    s *= k;
    *e0 = y[0] > low ? (float)s[0] : 0;
    *e1 = y[1] > low ? (float)s[1] : 0;
}

/* The same for one. */
static inline float
rad_expf(double x)
{
    float e, again;

    rad_expf2(x, x, &e, &again);
    return e;
}

#endif
