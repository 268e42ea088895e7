/* cover.h - surfaces in the very same place
 *
 * Where a scene includes a luminaire twice, rays see one lamp and one reflector
 * there, which must not light for two.  Shadow rays would not tell, for they end
 * short of the place.  Surfaces are in the same place if their types and their
 * real arguments are equal.
 * Thread: any. */
#ifndef RAD_LIGHT_COVER_H
#define RAD_LIGHT_COVER_H

#include "scene/scene.h"

/* Set covered[i] for each of n surfaces, objects[obj[i]], that another of them
 * covers: rays see that one, by the tie rule (geom/geom.h).  Distant sources
 * cover none: they add up, as in rpict.  False: out of memory. */
bool rad_covered(const struct rad_object *objects, const int32_t *obj,
                 int32_t n, bool *covered);

#endif
