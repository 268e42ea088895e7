/* contour.c - see contour.h
 *
 * On a circle of radius R about c with unit normal n, let e1 be the direction
 * of c within its plane and e2 = n x e1, so that with q = |c within the plane|
 *     r = c + R (cos t e1 + sin t e2),
 *     r x dr = R ((c x e2) cos t - (c x e1) sin t + R n) dt,
 *     |r|^2 = A + B cos t,  A = c.c + R^2,  B = 2 R q.
 * The integrals of 1, cos t and sin t over this denominator are elementary.
 * Over the whole circle that of sin t is 0, and with D = sqrt(A^2 - B^2) the
 * others are 2 pi / D and -2 pi B / (D (A + D)), so that
 *     F = -pi R^2 / D ((1 - 2 q^2 / (A + D)) n + 2 (c.n) / (A + D) q e1).
 * For a face parallel or perpendicular to the disk these are factors B-13 and
 * B-12 of Howell, A catalog of radiation heat transfer configuration factors.
 */
#include "config.h"

#include "light/sample/contour.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* Below this B / A the integral of cos t is summed as a series in B / A, up to
 * its fourth power. */
#define NEARLY_ROUND 2e-3

void
rad_contour_edge(double F[3], const double a[3], const double b[3])
{
    double c[3], sine, angle;

    rad_cross(c, b, a);
    sine = rad_normalize(c);
    if (!(sine > 0))
        return; /* seen from along the edge */
    angle = rad_atan2(sine, rad_dot(a, b));
    rad_madd(F, F, angle / 2, c);
}

/* Antiderivative of 1 / (A + B cos t), continuous where tan t/2 is not;
 * *cos_t gets cos t. */
static double
inverse(double A, double B, double t, double *cos_t)
{
    double root = sqrt((A - B) * (A + B)),
           turns = floor((t + M_PI) / (2 * M_PI));
    double half = t / 2 - M_PI * turns, s, c;

    rad_sin_and_cos(half, &s, &c);
    *cos_t = 2 * c * c - 1;
    return 2 / root *
           (rad_atan2(sqrt(A - B) * s, sqrt(A + B) * c) + M_PI * turns);
}

/* Antiderivative of cos t / (A + B cos t); inverse is that of 1 / (A + B cos t)
 * at the same t. */
static double
cosine(double A, double B, double t, double inverse)
{
    double x = B / A, s, s3, c2, c4;

    if (x > NEARLY_ROUND)
        return (t - A * inverse) / B;
    /* antiderivatives of cos, cos^2, cos^3, cos^4: s, c2, s3, c4 */
    s = rad_sin(t);
    s3 = s - s * s * s / 3;
    c2 = t / 2 + rad_sin(2 * t) / 4;
    c4 = 3 * t / 8 + rad_sin(2 * t) / 4 + rad_sin(4 * t) / 32;
    return (s - x * (c2 - x * (s3 - x * c4))) / A;
}

void
rad_contour_arc(double F[3], const double c[3], const double normal[3],
                double radius, const double middle[3], double delta,
                double sign)
{
    double e1[3], e2[3], w1[3], w2[3], q, A, B, at, from, to;

    rad_madd(e1, c, -rad_dot(c, normal), normal);
    q = rad_normalize(e1);
    if (!(q > 1e-12 * radius)) { /* on the axis e1 is any direction */
        rad_copy(e1, middle);
        q = 0;
    }
    rad_cross(e2, normal, e1);
    A = rad_dot(c, c) + radius * radius;
    B = 2 * radius * q;
    at = rad_atan2(rad_dot(middle, e2), rad_dot(middle, e1));
    from = at - delta;
    to = at + delta;
    rad_cross(w1, c, e1);
    rad_cross(w2, c, e2);
    double cos_to, end = inverse(A, B, to, &cos_to);
    double cos_from, begin = inverse(A, B, from, &cos_from);
    double cos_part = cosine(A, B, to, end) - cosine(A, B, from, begin);
    double sin_part = B > 0
                          ? -rad_log((A + B * cos_to) / (A + B * cos_from)) / B
                          : (cos_from - cos_to) / A;
    double k = -sign * radius / 2;

    rad_madd(F, F, k * cos_part, w2);
    rad_madd(F, F, -k * sin_part, w1);
    rad_madd(F, F, k * radius * (end - begin), normal);
}

void
rad_contour_circle(double F[3], const double c[3], const double normal[3],
                   double radius, double sign)
{
    double h = rad_dot(c, normal), side[3], q2, q, D, sum, k;

    rad_madd(side, c, -h, normal);
    q2 = rad_dot(side, side);
    q = sqrt(q2);
    /* A - B and A + B are the squared distances to the nearest and the farthest
     * place of the circle */
    D = sqrt((h * h + (q - radius) * (q - radius)) *
             (h * h + (q + radius) * (q + radius)));
    sum = q2 + h * h + radius * radius + D;
    k = -sign * M_PI * radius * radius / D;
    rad_madd(F, F, k * (1 - 2 * q2 / sum), normal);
    rad_madd(F, F, k * (2 * h / sum), side);
}
