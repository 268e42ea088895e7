/* ambshape.h - in how large a zone a new ambient record serves
 *
 * From the samples of its hemisphere: how E changes as the point moves and the
 * normal turns, the ellipse in which a linear extrapolation is good, from the
 * Hessian of E (gradient.h), and the directions in which a wall stands in it.
 * The ellipse's radii are kept as for -aa 1, and count times -aa.
 * Sources: Schwarzhaupt, Jensen & Jarosz 2012 (radii from the Hessian); Ward,
 * Rubinstein & Clear 1988 (mean distance, where all is black).
 * Thread: any; pure functions of their arguments.  */
#ifndef RAD_LIGHT_AMBSHAPE_H
#define RAD_LIGHT_AMBSHAPE_H

#include "light/indirect/ambient.h"
#include "light/hemisphere/hemisphere.h"

/* What radii go by: lengths in scene units. */
struct rad_ambscale {
    double side;        /* of the scene's cube */
    double least, most; /* radii: what -ar allows */
    double ambacc;      /* -aa */
    double shown;       /* rad_ambscale_reach() of what pixels show */
    double deep;        /* and of all else */
};

/* side: of the cube about all objects; 0: there is none. */
void rad_ambscale_set(struct rad_ambscale *scale, double side,
                      const struct rad_params *par);

/* The distance, in radii, up to which a record of that level is asked for. */
static inline double
rad_ambscale_reach(const struct rad_ambscale *scale, int level)
{
    return level > 0 ? scale->deep : scale->shown;
}

/* How far from a record with these radii E is about linear, in the mean of all
 * directions, and the second derivative of E over E for which it has them. */
double rad_ambscale_linear(const struct rad_ambscale *scale,
                           const float radius[2]);
double rad_ambscale_bend(const struct rad_ambscale *scale,
                         const float radius[2]);

/* What is spent on a record, as a part of what a bright pixel gets: less for a
 * lighter ray, and for a deeper one. */
double rad_ambrec_worth(const struct rad_ambrec *rec);

/* Set axes, radii, gradients and corral of *rec, the sampling of whose place is
 * h.  E, level and weight are there. */
void rad_ambrec_shape(const struct rad_ambscale *scale,
                      const struct rad_hemi *h, struct rad_ambrec *rec);

#endif
