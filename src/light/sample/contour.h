/* contour.h - the flux of a flat lamp by its outline
 *
 * The irradiance vector per radiance of a uniform flat shape, seen from the
 * origin, is an integral along its outline: with r from the origin,
 *     F = -1/2 integral r x dr / |r|^2,
 * counter-clockwise about the shape's normal, which faces the origin.  A
 * surface there with normal n, above whose horizon the shape lies, has the
 * irradiance F.n.  Straight edges give Lambert's formula; circles are
 * elementary too, for along one |r|^2 is A + B cos(angle). Source: Lambert
 * 1760; Arvo 1994, The irradiance Jacobian.  */
#ifndef RAD_LIGHT_CONTOUR_H
#define RAD_LIGHT_CONTOUR_H

#include "base/vec.h"

/* Add the part of the straight edge from a to b to F. */
void rad_contour_edge(double F[3], const double a[3], const double b[3]);

/* Add `sign` times the part of the arc about c, of a circle with this unit
 * normal, that goes counter-clockwise from `delta` before to `delta` behind the
 * unit direction `middle`; delta is at most pi. */
void rad_contour_arc(double F[3], const double c[3], const double normal[3],
                     double radius, const double middle[3], double delta,
                     double sign);

/* Add `sign` times the whole circle about c to F: the arc of delta pi, without
 * its angles. */
void rad_contour_circle(double F[3], const double c[3], const double normal[3],
                        double radius, double sign);

/* An outline is whole, and its shape lies toward `to`: F, which has the other
 * sign if the corners went round the other way, becomes a direction in dir.
 * Returns its length; not positive: there is nothing. */
static inline double
rad_contour_whole(const double F[3], const double to[3], double dir[3])
{
    rad_scale(dir, rad_dot(F, to) < 0 ? -1 : 1, F);
    return rad_normalize(dir);
}

#endif
