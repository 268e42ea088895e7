/* patch.h - parts of lamps, and their flux toward a point by their outlines
 *
 * A flat lamp or a cylinder is looked at in parts that are small for where it
 * is looked at from (sample.c).  Here is what a part is, and what of its light
 * arrives: contour.h's sum over its outline, exact from near and far; or of
 * what of it is above the horizon of a surface.  The flux F of a part is the
 * irradiance vector per radiance, toward it.  Thread: any.  */
#ifndef RAD_LIGHT_PATCH_H
#define RAD_LIGHT_PATCH_H

#include "light/sample/polytree.h"
#include "light/sample/sample.h"
#include "arith/elementary.h"
#include "base/vec.h"

#include <math.h>

struct rad_patch {
    enum {
        RAD_PATCH_TRIANGLE,
        RAD_PATCH_SECTOR,
        RAD_PATCH_LINE,
        RAD_PATCH_GROUP
    } kind;
    int budget;                      /* patches that may come of it */
    double p[3], u[3], v[3];         /* of a line: centre and half-axis u; of a
                                      * triangle: corner and sides */
    double r0, r1, phi, delta;       /* of a sector: radii; middle and half
                                      * angle */
    const struct rad_polytree *node; /* of a group */
};

/* The place of a disk or ring at distance r from its middle and angle phi. */
static inline void
rad_ring_point(const struct rad_source *src, double r, double phi, double p[3])
{
    double x, y;

    /* the axes' length is that of the square that stands for the ring */
    double s = r / sqrt(rad_dot(src->axis[0], src->axis[0]));

    rad_sin_and_cos(phi, &y, &x);
    for (int k = 0; k < 3; k++)
        p[k] = src->centre[k] + s * (x * src->axis[0][k] + y * src->axis[1][k]);
}

/* Add its flux toward `at`, whose sign says which way its corners go round.  A
 * stretch of cylinder has none here. */
void rad_patch_flux(double F[3], const struct rad_source *src,
                    const double at[3], const struct rad_patch *p);

/* The sample of a patch that may lie across the horizon of view->up: it aims at
 * a place above, and has the flux of what is there.  False: that is nothing. */
bool rad_patch_risen(struct rad_light_sample *s, const struct rad_source *src,
                     const struct rad_light_view *view,
                     const struct rad_patch *p);

#endif
