/* expf.h - exp() to the accuracy of a float
 *
 * For what a medium lets through, which becomes a colour in float.  An exp()
 * that is right to the last bit of a double takes twice as long.
 * With k the integer nearest to x / ln 2 and f the remainder, |f| <= 1/2,
 * exp(x) is 2^k times the Taylor series of exp(f ln 2).  Seven powers leave an
 * error below (ln 2 / 2)^8 / 8! = 5.2e-9, a tenth of that of rounding to
 * float. */
#ifndef RAD_ARITH_EXPF_H
#define RAD_ARITH_EXPF_H

#include <stdint.h>
#include <string.h>

typedef double rad_v2d __attribute__((vector_size(16)));
typedef uint64_t rad_v2u __attribute__((vector_size(16)));

/* For two numbers x <= 0.  The result is 0 if a float holds nothing so small,
 * or if x is NaN. */
static inline void
rad_expf2(double x0, double x1, float *e0, float *e1)
{
    /* adding this to a number rounds it to an integer, in the low bits */
    const rad_v2d magic = { 0x1.8p52, 0x1.8p52 }, low = { -150, -150 };
    const rad_v2d one = { 1, 1 },
                  per_ln2 = { 1.4426950408889634, 1.4426950408889634 };
    rad_v2d x = { x0, x1 }, y = x * per_ln2, k = y + magic;
    rad_v2d f = y - (k - magic), f2 = f * f, s;
    rad_v2u bits;

    /* (ln 2)^n / n! */
    const rad_v2d c1 = { 0.6931471805599453, 0.6931471805599453 },
                  c2 = { 0.2402265069591007, 0.2402265069591007 },
                  c3 = { 0.05550410866482158, 0.05550410866482158 },
                  c4 = { 0.009618129107628477, 0.009618129107628477 },
                  c5 = { 0.0013333558146428443, 0.0013333558146428443 },
                  c6 = { 0.0001540353039338161, 0.0001540353039338161 },
                  c7 = { 1.5252733804059841e-05, 1.5252733804059841e-05 };

    s = (one + f * c1) + f2 * (c2 + f * c3) +
        f2 * f2 * ((c4 + f * c5) + f2 * (c6 + f * c7));
    memcpy(&bits, &k, sizeof bits);
    bits = ((bits + 1023) << 52) & (rad_v2u)(y > low);
    memcpy(&k, &bits, sizeof k);
    s *= k; /* 0 below the range of float; NaN stays NaN */
    *e0 = y[0] > low[0] ? (float)s[0] : 0;
    *e1 = y[1] > low[1] ? (float)s[1] : 0;
}

/* The same for one number. */
static inline float
rad_expf(double x)
{
    float e, again;

    rad_expf2(x, x, &e, &again);
    return e;
}

#endif
