/* quad.h - where on a parallelogram to look from a given point
 *
 * Most lamps are parallelograms, and to make the samples of lamps is most of
 * the cost of direct light.  So parallelograms have code of their own, which
 * makes two samples at a time; sample.c has the other shapes.  sample.h says
 * what a sample is.
 * Thread: any.  */
#ifndef RAD_LIGHT_QUAD_H
#define RAD_LIGHT_QUAD_H

#include "light/sample/sample.h"

#include <math.h>

/* A source is cut into so many patches at most, as in rpict. */
#define RAD_LIGHT_PATCHES 64

/* The variance, along one side, of a square whose side is sizerat (-ds) times
 * its distance; over the squared distance. */
static inline double
rad_side_limit(double sizerat)
{
    return sizerat * sizerat / 12;
}

/* Is a parallelogram or a stretch of cylinder small enough: is its variance at
 * most `limit` in all directions?  aa, bb and ab are the products a.a, b.b and
 * a.b of the axes of its moments. */
static inline bool
rad_side_small_enough(double aa, double bb, double ab, double limit)
{
    /* the largest variance is at least max(aa, bb), at most aa + bb */
    if (aa > limit || bb > limit)
        return false;
    if (aa + bb <= limit)
        return true;
    double half = (aa - bb) / 2;

    return (aa + bb) / 2 + sqrt(half * half + ab * ab) <= limit;
}

/* Make the samples of *src, a parallelogram with the point before its front, in
 * a fixed order; returns their number.  The caller drops samples whose omega is
 * not positive, or that a glow's reach or a spotlight's cone leaves out. */
int rad_quad_samples(const struct rad_source *src,
                     const struct rad_light_view *view,
                     struct rad_light_sample s[RAD_LIGHT_PATCHES]);

#endif
