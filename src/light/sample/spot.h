/* spot.h - the cone within which a spotlight material shines
 *
 * A spotlight shines within a cone about a fixed direction, and its light
 * comes from a focus behind the surface: at distance d from the surface it
 * falls off as 1/(d + focal length)^2.
 * Source: Radiance reference manual, "spotlight". */
#ifndef RAD_LIGHT_SPOT_H
#define RAD_LIGHT_SPOT_H

#include <stdbool.h>

struct rad_spot {
    double aim[3];       /* unit direction of the cone's axis */
    double focal_length; /* [scene units] */
    double omega;        /* solid angle of the cone [sr] */
};

/* Fill in *spot from the seven real arguments of a spotlight: red green blue,
 * full angle [degrees], direction with the focal length as its length.  False:
 * the angle is not positive, or the direction zero. */
bool rad_spot_init(struct rad_spot *spot, const double reals[7]);

/* Does a ray that runs in unit direction dir toward the light, from outside,
 * miss the cone? */
bool rad_spot_outside(const struct rad_spot *spot, const double dir[3]);

#endif
