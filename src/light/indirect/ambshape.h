/* ambshape.h - the gradients, radii and corral of a new ambient record
 *
 * From the hits of its hemisphere follow the gradients of E as the point moves
 * and the normal turns; the ellipse in which a linear extrapolation is good,
 * from the Hessian of E (gradient.h); and the directions in which a wall stands
 * in the ellipse.  The ellipse's radii are kept as for -aa 1, and are used
 * times -aa.
 * Sources: Schwarzhaupt, Jensen & Jarosz 2012 (radii from the Hessian); Ward,
 * Rubinstein & Clear 1988 (mean distance, where all is black).
 * Thread: any; pure functions of their arguments.  */
#ifndef RAD_LIGHT_AMBSHAPE_H
#define RAD_LIGHT_AMBSHAPE_H

#include "light/indirect/ambient.h"
#include "light/hemisphere/hemisphere.h"

/* The limits and factors of radii; lengths in scene units. */
struct rad_ambscale {
    double side;        /* of the scene's cube */
    double shown_side;  /* of the part that pictures show (--surroundings) */
    double least, most; /* radii that -ar allows, near what is shown */
    double widest;      /* `most` grows up to this, far from what is shown */
    double at[3], within; /* centre and radius of the ball that holds that;
                           * radius INFINITY: it may be anywhere */
    double ambacc;      /* -aa */
    double shown;       /* rad_ambscale_reach() of level 0 */
    double deep;        /* rad_ambscale_reach() of other levels */
};

/* side: of the cube about all objects; 0: there are none. */
void rad_ambscale_set(struct rad_ambscale *scale, double side,
                      const struct rad_params *par);

/* The distance, in radii, up to which a record of that level is averaged. */
static inline double
rad_ambscale_reach(const struct rad_ambscale *scale, int level)
{
    return level > 0 ? scale->deep : scale->shown;
}

/* Limit the radii of a record whose job may have shown another part of the
 * scene, and so had wider zones here. */
void rad_ambrec_narrow(const struct rad_ambscale *scale,
                       struct rad_ambrec *rec);

/* The distance from a record with these radii within which E is about linear, a
 * mean over all directions [scene units]. */
double rad_ambscale_linear(const struct rad_ambscale *scale,
                           const float radius[2]);
/* The second derivative of E over E that gives these radii, a mean over all
 * directions [1/unit^2]. */
double rad_ambscale_bend(const struct rad_ambscale *scale,
                         const float radius[2]);

/* The part of -ad and -as that a record gets: 1 for a record that a pixel shows
 * unattenuated, less for records of lighter and deeper rays. */
double rad_ambrec_worth(const struct rad_ambrec *rec);

/* Set axes, radii, gradients and corral of *rec, whose hemisphere is h.  The
 * caller has set E, level and weight. */
void rad_ambrec_shape(const struct rad_ambscale *scale,
                      const struct rad_hemi *h, struct rad_ambrec *rec);

#endif
