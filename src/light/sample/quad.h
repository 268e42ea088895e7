/* quad.h - where on a parallelogram to look from a given point
 *
 * Most lamps are parallelograms, and most of what direct light costs is where
 * on them to look: so their parts are cut and weighed here, two at a time, and
 * not as those of the other shapes (sample.c).  sample.h says what a sample
 * is.  */
#ifndef RAD_LIGHT_QUAD_H
#define RAD_LIGHT_QUAD_H

#include "light/sample/sample.h"

#include <math.h>

/* Patches of one source at most, as in rpict. */
#define RAD_LIGHT_PATCHES 64

/* The variance of a square whose side is -ds of its distance, over the square
 * of that. */
static inline double
rad_side_limit(double sizerat)
{
    return sizerat * sizerat / 12;
}

/* Is a parallelogram or a stretch of cylinder small enough, by its longer side,
 * that a square may have a variance of `limit` there?  aa, bb and ab are the
 * products of the axes of its moments. */
static inline bool
rad_side_small_enough(double aa, double bb, double ab, double limit)
{
    /* the largest variance is at least the larger, at most the sum */
    if (aa > limit || bb > limit)
        return false;
    if (aa + bb <= limit)
        return true;
    double half = (aa - bb) / 2;

    return (aa + bb) / 2 + sqrt(half * half + ab * ab) <= limit;
}

/* The samples of *src, a parallelogram whose front the point faces, in a fixed
 * order; omega may be no positive number, and nothing is asked of a glow's
 * reach or a spotlight's cone.  Returns how many there are. */
int rad_quad_samples(const struct rad_source *src,
                     const struct rad_light_view *view,
                     struct rad_light_sample s[RAD_LIGHT_PATCHES]);

#endif
