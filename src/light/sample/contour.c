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

/* Antiderivative of cos t / (1 + x cos t), for small x, at t with that sine and
 * cosine. */
static double
cosine_sum(double x, double t, double sine, double cos_t)
{
    /* antiderivatives of cos, cos^2, cos^3, cos^4: sine, c2, s3, c4 */
    double sin_2t = 2 * sine * cos_t, cos_2t = 1 - 2 * sine * sine;
    double s3 = sine - sine * sine * sine / 3;
    double c2 = t / 2 + sin_2t / 4;
    double c4 = 3 * t / 8 + sin_2t / 4 + sin_2t * cos_2t / 16;

    return sine - x * (c2 - x * (s3 - x * c4));
}

/* With k = sqrt((A - B) / (A + B)) an antiderivative of 1 / (A + B cos t) is
 * atan(k tan t/2) times 2 / sqrt(A^2 - B^2): the difference of two such angles
 * is that of a product of complex numbers. */
void
rad_contour_arc(double F[3], const double c[3], const double normal[3],
                double radius, const double middle[3], double delta,
                double sign)
{
    double e1[3], e2[3], w1[3], w2[3], q, A, B;

    rad_madd(e1, c, -rad_dot(c, normal), normal);
    q = rad_normalize(e1);
    if (!(q > 1e-12 * radius)) { /* on the axis e1 is any direction */
        rad_copy(e1, middle);
        q = 0;
    }
    rad_cross(e2, normal, e1);
    A = rad_dot(c, c) + radius * radius;
    B = 2 * radius * q;
    rad_cross(w1, c, e1);
    rad_cross(w2, c, e2);

    double sd, cd, cm = rad_dot(middle, e1), sm = rad_dot(middle, e2);

    rad_sin_and_cos(delta, &sd, &cd);

    double cos_from = cm * cd + sm * sd, cos_to = cm * cd - sm * sd;
    double root = sqrt((A - B) * (A + B));
    double all = 2 / root * rad_atan2(root * sd, A * cd + B * cm);
    double x = B / A, k = -sign * radius / 2, cos_part, sin_part;

    if (x > NEARLY_ROUND)
        cos_part = (2 * delta - A * all) / B;
    else
        cos_part = (cosine_sum(x, delta, sm * cd + cm * sd, cos_to) -
                    cosine_sum(x, -delta, sm * cd - cm * sd, cos_from)) /
                   A;
    sin_part = B > 0 ? -rad_log((A + B * cos_to) / (A + B * cos_from)) / B
                     : (cos_from - cos_to) / A;
    rad_madd(F, F, k * cos_part, w2);
    rad_madd(F, F, -k * sin_part, w1);
    rad_madd(F, F, k * radius * all, normal);
}

/* Here e1 points from the origin's foot on the axis to c, and t goes from pi -
 * delta to pi + delta: the integral of sin t is 0, and c x e2 = h axis - z e1.
 */
void
rad_contour_end(double F[2], double z, double h, double radius, double delta,
                double sign)
{
    double near2 = z * z + (h - radius) * (h - radius); /* A - B */
    double far2 = z * z + (h + radius) * (h + radius);  /* A + B */
    double A = z * z + h * h + radius * radius, B = 2 * radius * h;
    double k = -sign * radius / 2, cos_part;
    double all = 4 / sqrt(near2 * far2) *
                 rad_atan2(sqrt(far2 * (h - radius)),
                           sqrt(near2 * (h + radius))); /* integral of 1 */

    if (B > NEARLY_ROUND * A)
        cos_part = (2 * delta - A * all) / B;
    else
        cos_part =
            -2 * cosine_sum(-B / A, delta, rad_sin(delta), radius / h) / A;
    F[0] += k * (cos_part * h + radius * all);
    F[1] -= k * cos_part * z;
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
