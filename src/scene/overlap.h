/* overlap.h - does a surface meet a cube?
 *
 * Conservative: true where rounding leaves it open, and for a polygon also
 * where the cube lies in its hole.
 * Sources: Sutherland & Hodgman 1974 (clipping); Akenine-Moller 2001 (triangle
 * and box); a point's distance to a sphere or a cone is its distance to their
 * generating curve in the half-plane through the axis; Gottschalk, Lin &
 * Manocha 1996, OBBTree (two boxes).  */
#ifndef RAD_GEOM_OVERLAP_H
#define RAD_GEOM_OVERLAP_H

#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/* What is kept of a surface: bounds, and how far it may lie from where its
 * arguments say (the vertices of a polygon from their plane). */
struct rad_extent {
    double lo[3], hi[3];
    double slack;
};

/* False: not finite, or without area; it meets nothing. */
bool rad_extent_of(const struct rad_object *o, struct rad_extent *e);

/* Does o, with extent e, meet the cube of half-edge `half` around centre? */
bool rad_overlaps_cube(const struct rad_object *o, const struct rad_extent *e,
                       const double centre[3], double half);

/* Which of the eight parts of that cube, which it meets?  Bit k: the part in
 * the upper half along axis i if k has bit i. */
uint8_t rad_overlaps_parts(const struct rad_object *o,
                           const struct rad_extent *e, const double centre[3],
                           double half);

#endif
