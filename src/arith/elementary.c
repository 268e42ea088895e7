/* elementary.c - sines, powers and the like, with the same bits everywhere
 *
 * A logarithm is ln 2 times the exponent plus the logarithm of the mantissa m
 * in [sqrt(1/2), sqrt(2)), which is 2 artanh(s), s = (m - 1) / (m + 1), by the
 * series s + s^3 / 3 + s^5 / 5 + ...  A power needs more bits of the logarithm
 * than a double has: so the first two terms are sums of two doubles, by the
 * exact products and sums of Dekker (A floating-point technique for extending
 * the available precision, 1971).  Sines are reduced to an eighth of a turn by
 * pi / 2 in three parts (Cody and Waite 1980); the first two have 33 bits, so
 * their products with whole numbers below 2^20 are exact. */
#include "config.h"
#include "arith/elementary.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "arith/angle.h"
#include "arith/bits.h"

#define LN2_HIGH       0x1.62e42feep-1 /* 32 bits: k LN2_HIGH is exact */
#define LN2_LOW        0x1.a39ef35793c76p-33
#define HALF_PI_HIGH   0x1.921fb544p+0
#define HALF_PI_MIDDLE 0x1.0b4611a6p-34
#define HALF_PI_LOW    0x1.3198a2e037073p-69

/* Beyond so many quarter turns sines are libm's. */
#define MOST_QUARTERS 0x1p20

/* hi + lo, |lo| at most half a unit in the last place of hi. */
struct pair {
    double hi, lo;
};

/* a + b exactly, |a| >= |b|. */
static inline struct pair
sum_of(double a, double b)
{
    double s = a + b;

    return (struct pair){ s, b - (s - a) };
}

/* a b exactly, both below 2^996. */
static inline struct pair
product_of(double a, double b)
{
    const double splitter = 0x1p27 + 1;
    double a1 = splitter * a, b1 = splitter * b, a2, b2, p = a * b;

    a1 -= a1 - a;
    b1 -= b1 - b;
    a2 = a - a1;
    b2 = b - b1;
    return (struct pair){ p, a1 * b1 - p + a1 * b2 + a2 * b1 + a2 * b2 };
}

/* x = mantissa 2^exponent, x > 0 and finite, mantissa in [1, 2). */
static double
mantissa_of(double x, int *exponent)
{
    uint64_t bits = rad_bits_of(x);

    *exponent = (int)(bits >> 52) - 1023;
    if (*exponent == -1023) {
        bits = rad_bits_of(x * 0x1p54);
        *exponent = (int)(bits >> 52) - 1023 - 54;
    }
    return rad_double_of((bits & (UINT64_MAX >> 12)) | UINT64_C(1023) << 52);
}

/* Half the logarithm of m in [sqrt(1/2), sqrt(2)). */
static struct pair
half_log(double m)
{
    const double third = 0x1.5555555555555p-2,
                 third_low = 0x1.5555555555555p-56;
    double f = m - 1, d = m + 1, d_low = m - (d - 1), z2, rest;
    struct pair s, p, z, q, g;

    s.hi = f / d;
    p = product_of(s.hi, d);
    s.lo = (f - p.hi - p.lo - s.hi * d_low) / d;
    z = product_of(s.hi, s.hi);
    z.lo += 2 * s.hi * s.lo;
    z2 = z.hi * z.hi;
    rest = (1. / 5 + z.hi / 7) + z2 * (1. / 9 + z.hi / 11) +
           z2 * z2 *
               ((1. / 13 + z.hi / 15) + z2 * (1. / 17 + z.hi / 19) +
                z2 * z2 * (1. / 21 + z.hi / 23 + z2 / 25));
    p = product_of(z.hi, third);
    p.lo += z.hi * third_low + z.lo * third;
    q = sum_of(p.hi, z2 * rest);
    q.lo += p.lo;
    g = product_of(s.hi, q.hi);
    g.lo += s.hi * q.lo + s.lo * q.hi;
    p = sum_of(s.hi, g.hi);
    p.lo += s.lo + g.lo;
    return p;
}

/* The logarithm of x > 0, finite, with a relative error of some 2^-64. */
static struct pair
log_of(double x)
{
    int k;
    double m = mantissa_of(x, &k);
    struct pair half, sum;

    if (m > M_SQRT2) {
        m /= 2;
        k++;
    }
    half = half_log(m);
    if (k == 0)
        return sum_of(2 * half.hi, 2 * half.lo);
    sum = sum_of(k * LN2_HIGH, 2 * half.hi);
    return sum_of(sum.hi, sum.lo + (2 * half.lo + k * LN2_LOW));
}

/* exp(x + low), where low is at most a unit in the last place of x. */
static double
exp_of(double x, double low)
{
    const double magic = 0x1.8p52;
    double k, r, r2, r4, sum;

    if (!(x > -746))
        return x <= -746 ? 0 : x;
    if (x > 710)
        return INFINITY;
    k = (x * 0x1.71547652b82fep+0 + magic) - magic;
    r = (x - k * LN2_HIGH) - (k * LN2_LOW - low);
    r2 = r * r;
    r4 = r2 * r2;
    sum = (1. / 2 + r * (1. / 6)) + r2 * (1. / 24 + r * (1. / 120)) +
          r4 * ((1. / 720 + r * (1. / 5040)) +
                r2 * (1. / 40320 + r * (1. / 362880)) +
                r4 * ((1. / 3628800 + r * (1. / 39916800)) +
                      r2 * (1. / 479001600 + r * (1. / 6227020800))));
    sum = 1 + (r + r2 * sum);
    if (k > -1022 && k < 1024)
        return sum * rad_power_of_two((int)k);
    return ldexp(sum, (int)k);
}

/* x = r + *low + n pi / 2, |r| <= pi / 4; false: x is too large. */
static bool
reduce(double x, double *r, double *low, unsigned *n)
{
    const double magic = 0x1.8p52;
    double k, y, w, z;

    if (fabs(x) <= M_PI / 4) {
        *r = x;
        *low = 0;
        *n = 0;
        return true;
    }
    if (!(fabs(x) < MOST_QUARTERS * (M_PI / 2)))
        return false;
    k = (x * M_2_PI + magic) - magic;
    y = x - k * HALF_PI_HIGH;
    w = k * HALF_PI_MIDDLE;
    z = y - w;
    w = (y - z) - w - k * HALF_PI_LOW;
    *r = z + w;
    *low = (z - *r) + w;
    *n = (unsigned)(int)k;
    return true;
}

void
rad_sin_and_cos(double x, double *sine, double *cosine)
{
    double r, low, s, c;
    unsigned n;

    if (!reduce(x, &r, &low, &n)) {
        *sine = sin(x);
        *cosine = cos(x);
        return;
    }
    rad_sin_cos(r, &s, &c);
    s += low * (1 - r * r / 2);
    c -= low * r;
    *sine = n & 1 ? c : s;
    *cosine = n & 1 ? s : c;
    if (n & 2)
        *sine = -*sine;
    if ((n + 1) & 2)
        *cosine = -*cosine;
    if (x == 0)
        *sine = x; /* keeps the sign of -0 */
}

double
rad_sin(double x)
{
    double s, c;

    rad_sin_and_cos(x, &s, &c);
    return s;
}

double
rad_cos(double x)
{
    double s, c;

    rad_sin_and_cos(x, &s, &c);
    return c;
}

double
rad_tan(double x)
{
    double s, c;

    rad_sin_and_cos(x, &s, &c);
    return s / c;
}

double
rad_asin(double x)
{
    return rad_atan2(x, sqrt((1 - x) * (1 + x)));
}

double
rad_acos(double x)
{
    return rad_atan2(sqrt((1 - x) * (1 + x)), x);
}

double
rad_atan(double x)
{
    return copysign(rad_angle(fabs(x), 1), x);
}

double
rad_atan2(double y, double x)
{
    double large = fmax(fabs(x), fabs(y));

    if (!(large < INFINITY) || large == 0)
        return atan2(y, x);
    if (large > 0x1p1000) {
        x *= 0x1p-100;
        y *= 0x1p-100;
    }
    return copysign(rad_angle(fabs(y), x), y);
}

double
rad_exp(double x)
{
    return exp_of(x, 0);
}

double
rad_log(double x)
{
    if (!(x > 0 && x < INFINITY))
        return log(x);
    return log_of(x).hi;
}

double
rad_log10(double x)
{
    const double inverse = 0x1.bcb7b1526e50ep-2, low = 0x1.95355baaafad3p-57;
    struct pair l, p;

    if (!(x > 0 && x < INFINITY))
        return log10(x);
    l = log_of(x);
    p = product_of(l.hi, inverse);
    return p.hi + (p.lo + (l.hi * low + l.lo * inverse));
}

double
rad_pow(double x, double y)
{
    struct pair l, p;

    if (x < 0 && x > -INFINITY && floor(y) == y && fabs(y) < INFINITY)
        return fmod(y, 2) == 0 ? rad_pow(-x, y) : -rad_pow(-x, y);
    if (!(x > 0 && x < INFINITY && fabs(y) < INFINITY))
        return pow(x, y);
    l = log_of(x);
    if (l.hi == 0)
        return 1;
    if (!(fabs(y * l.hi) < 800))
        return exp_of(y * l.hi, 0);
    p = product_of(y, l.hi);
    p.lo += y * l.lo;
    return exp_of(p.hi, p.lo);
}

double
rad_cbrt(double x)
{
    int k, third;
    double m, root;

    if (!(fabs(x) > 0 && fabs(x) < INFINITY))
        return x;
    m = mantissa_of(fabs(x), &k);
    third = (k + 1200) / 3 - 400;
    m = ldexp(m, k - 3 * third); /* in [1, 8) */
    root = .7 + m * (.38 - m * .0275);
    for (int i = 0; i < 5; i++)
        root += (m / (root * root) - root) / 3;
    return copysign(ldexp(root, third), x);
}

double
rad_hypot(double x, double y)
{
    double large = fmax(fabs(x), fabs(y));

    if (!(large > 0x1p-500 && large < 0x1p500)) {
        if (!(large > 0 && large < INFINITY))
            return hypot(x, y);
        return large *
               sqrt((x / large) * (x / large) + (y / large) * (y / large));
    }
    return sqrt(x * x + y * y);
}
