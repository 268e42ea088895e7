/* patch.h - parts of lamps, and their flux toward a point by their outlines
 *
 * A flat lamp or a cylinder is cut into patches that are small against their
 * distance from a point (sample.c).  This file defines a patch, and computes
 * its flux toward the point by its outline (contour.h), exactly at any
 * distance: of the whole patch, or of its part above the horizon of a surface.
 * The flux F of a patch is the irradiance vector per radiance; it points toward
 * the patch.
 * Thread: any.  */
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
    int budget;                      /* how many patches this patch may be cut
                                      * into */
    double p[3], u[3], v[3];         /* LINE, a stretch of cylinder: centre and
                                      * half-axis u; TRIANGLE: corner, sides */
    double r0, r1, phi, delta;       /* SECTOR of a ring: inner and outer
                                      * radius; middle and half angle */
    const struct rad_polytree *node; /* GROUP of triangles */
};

/* The place of a disk or ring at distance r from its middle and angle phi. */
static inline void
rad_ring_point(const struct rad_source *src, double r, double phi, double p[3])
{
    double x, y;

    /* the axes are those of a square (shape.c): only their directions count */
    double s = r / sqrt(rad_dot(src->axis[0], src->axis[0]));

    rad_sin_and_cos(phi, &y, &x);
    for (int k = 0; k < 3; k++)
        p[k] = src->centre[k] + s * (x * src->axis[0][k] + y * src->axis[1][k]);
}

/* Add the flux toward `at` of patch p, which is no LINE, to F.  The flux is
 * negative if the patch's corners, seen from `at`, go round clockwise. */
void rad_patch_flux(double F[3], const struct rad_source *src,
                    const double at[3], const struct rad_patch *p);

/* Make the sample of patch p, which is no LINE and may lie across the horizon
 * of view->up.  The sample aims at a place above the horizon; its dir and omega
 * are the flux of the part above.  False: no light comes from above. */
bool rad_patch_risen(struct rad_light_sample *s, const struct rad_source *src,
                     const struct rad_light_view *view,
                     const struct rad_patch *p);

#endif
