/* vec.h - points and vectors in double[3]
 *
 * Plain arrays, so that formulas read as in the literature.  No function here
 * fails; rad_normalize() returns 0 for a vector without a direction. */
#ifndef RAD_BASE_VEC_H
#define RAD_BASE_VEC_H

#include <math.h>

static inline double
rad_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The size of v along n, each axis by itself. */
static inline double
rad_dot_sizes(const double n[3], const double v[3])
{
    return fabs(n[0] * v[0]) + fabs(n[1] * v[1]) + fabs(n[2] * v[2]);
}

static inline void
rad_copy(double d[3], const double a[3])
{
    d[0] = a[0];
    d[1] = a[1];
    d[2] = a[2];
}

static inline void
rad_sub(double d[3], const double a[3], const double b[3])
{
    d[0] = a[0] - b[0];
    d[1] = a[1] - b[1];
    d[2] = a[2] - b[2];
}

/* d = a + s*b */
static inline void
rad_madd(double d[3], const double a[3], double s, const double b[3])
{
    d[0] = a[0] + s * b[0];
    d[1] = a[1] + s * b[1];
    d[2] = a[2] + s * b[2];
}

static inline void
rad_scale(double d[3], double s, const double a[3])
{
    d[0] = s * a[0];
    d[1] = s * a[1];
    d[2] = s * a[2];
}

/* d = a x b; d must not be a or b. */
static inline void
rad_cross(double d[3], const double a[3], const double b[3])
{
    d[0] = a[1] * b[2] - a[2] * b[1];
    d[1] = a[2] * b[0] - a[0] * b[2];
    d[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double
rad_dist2(const double a[3], const double b[3])
{
    double d[3];

    rad_sub(d, a, b);
    return rad_dot(d, d);
}

/* The smaller and the larger of two numbers; b, if a is NaN.  Unlike fmin() and
 * fmax(), which have rules for NaN, these are not function calls. */
static inline double
rad_least(double a, double b)
{
    return a < b ? a : b;
}

static inline double
rad_most(double a, double b)
{
    return a > b ? a : b;
}

/* rad_normalize() for a vector whose squared length is out of range. */
static inline double
rad_normalize_scaled(double v[3])
{
    double m = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    double len;

    if (!(m > 0 && m < INFINITY))
        return 0;
    double x = v[0] / m, y = v[1] / m, z = v[2] / m;

    len = sqrt(x * x + y * y + z * z);
    if (!(len > 0))
        return 0;
    v[0] = x / len;
    v[1] = y / len;
    v[2] = z / len;
    return len * m;
}

/* Scale v to unit length.  Returns its former length, or 0, with v unchanged,
 * if that is zero or not finite.  Where the squared length would lose digits or
 * overflow, v is first divided by its largest component, so lengths from 1e-300
 * to 1e300 are safe. */
static inline double
rad_normalize(double v[3])
{
    double q = rad_dot(v, v), len;

    if (!(q > 0x1p-900 && q < 0x1p+1000))
        return rad_normalize_scaled(v);
    len = sqrt(q);
    v[0] /= len;
    v[1] /= len;
    v[2] /= len;
    return len;
}

/* Unit vectors u and v that make a right-handed frame (u, v, n) with unit n.
 * Source: Duff et al. 2017, Building an orthonormal basis, revisited. */
static inline void
rad_frame(double u[3], double v[3], const double n[3])
{
    double s = copysign(1.0, n[2]);
    double a = -1.0 / (s + n[2]);
    double b = n[0] * n[1] * a;

    u[0] = 1.0 + s * n[0] * n[0] * a;
    u[1] = s * b;
    u[2] = -s * n[0];
    v[0] = b;
    v[1] = s + n[1] * n[1] * a;
    v[2] = -n[1];
}

#endif
