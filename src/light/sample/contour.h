/* contour.h - the flux of a flat lamp by its outline
 *
 * The irradiance vector per radiance of a uniform flat shape, seen from the
 * origin, is an integral along its outline: with r from the origin,
 *     F = -1/2 integral r x dr / |r|^2,
 * counter-clockwise about the shape's normal, which faces the origin.  A
 * surface at the origin with normal n has the irradiance F.n, if the whole
 * shape lies above its horizon.  Straight edges give Lambert's formula; for
 * circles the integral is elementary, too, since along a circle |r|^2 is A + B
 * cos(angle).
 * Source: Lambert 1760; Arvo 1994, The irradiance Jacobian.  */
#ifndef RAD_LIGHT_CONTOUR_H
#define RAD_LIGHT_CONTOUR_H

#include "base/vec.h"

/* Add the integral along the straight edge from a to b to F. */
void rad_contour_edge(double F[3], const double a[3], const double b[3]);

/* Add `sign` times the integral along an arc to F.  The arc lies on the circle
 * about c with this radius and unit normal; it goes counter-clockwise from the
 * angle `delta` before the unit direction `middle` to `delta` after it.  delta
 * is at most pi. */
void rad_contour_arc(double F[3], const double c[3], const double normal[3],
                     double radius, const double middle[3], double delta,
                     double sign);

/* Add `sign` times the integral along the near arc of a cylinder's end to F, in
 * coordinates along the axis and across it, toward the axis.  The origin is at
 * distance h, above the radius, from the axis, and the end's centre lies z
 * along it.  The arc goes as far as the origin sees the wall, to the angle
 * delta = acos(radius / h) on both sides, counter-clockwise about the axis. */
void rad_contour_end(double F[2], double z, double h, double radius,
                     double delta, double sign);

/* Add `sign` times the integral along the whole circle about c to F. */
void rad_contour_circle(double F[3], const double c[3], const double normal[3],
                        double radius, double sign);

/* Split F, the integral along a whole outline, into a unit direction dir and
 * its length, which is returned; not positive: no light comes from the shape.
 * `to` is a direction to the shape: if the corners went round clockwise, F
 * points the other way and is reversed. */
static inline double
rad_contour_whole(const double F[3], const double to[3], double dir[3])
{
    rad_scale(dir, rad_dot(F, to) < 0 ? -1 : 1, F);
    return rad_normalize(dir);
}

#endif
