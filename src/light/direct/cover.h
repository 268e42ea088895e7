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

#include <stddef.h>

/* Drop from a list of *n structs those with a surface that another covers: rays
 * see that one, by the tie rule (geom/geom.h).  Distant sources cover none:
 * they add up, as in rpict. size  bytes of a struct at    where in it the
 * number of its object is, an int32_t False: out of memory. */
bool rad_drop_covered(const struct rad_object *objects, void *list, int32_t *n,
                      size_t size, size_t at);

#endif
