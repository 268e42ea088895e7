/* overlap.h - does a surface meet a cube?
 *
 * The answer is yes if rounding leaves it open, and for a polygon also if the
 * cube lies in a hole.
 * Sources: Sutherland & Hodgman 1974 (clipping); Akenine-Moller 2001 (triangle
 * and box); Gottschalk, Lin & Manocha 1996, OBBTree (two boxes).  The distance
 * of a point from a sphere or a cone is its distance from the generating curve,
 * in the half-plane through the axis and the point.  */
#ifndef RAD_SCENE_OVERLAP_H
#define RAD_SCENE_OVERLAP_H

#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/* Bounds of a surface, and how far it may lie from where its arguments put it
 * (a polygon's vertices need not be in one plane). */
struct rad_extent {
    double lo[3], hi[3];
    double slack;
};

/* False: the surface is not finite, or has no area, and meets no cube. */
bool rad_extent_of(const struct rad_object *o, struct rad_extent *e);

/* Does o, with extent e, meet the cube of half-edge `half` around centre? */
bool rad_overlaps_cube(const struct rad_object *o, const struct rad_extent *e,
                       const double centre[3], double half);

/* Which of the eight parts of a cube that o meets does o meet?  Bit k: the part
 * in the upper half along axis i if k has bit i. */
uint8_t rad_overlaps_parts(const struct rad_object *o,
                           const struct rad_extent *e, const double centre[3],
                           double half);

#endif
