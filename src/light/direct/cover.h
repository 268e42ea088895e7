/* cover.h - surfaces in the very same place
 *
 * Where a scene includes a luminaire twice, rays see one lamp and one reflector
 * there, which must not light for two; and a lamp under another surface is not
 * seen.  Shadow rays would not tell, for they end short of the place.  Surfaces
 * are in the same place if their types and their real arguments are equal; it
 * does not matter which of its corners a polygon begins with.
 * Thread: any. */
#ifndef RAD_LIGHT_COVER_H
#define RAD_LIGHT_COVER_H

#include "trace/job.h"

#include <stddef.h>

/* Drop from a list of *n structs those with a surface that another surface of
 * the scene covers: rays see that other, by the tie rule (geom/geom.h). Distant
 * sources cover none: they add up, as in rpict.
 *   size  bytes of a struct
 *   at    where in it the number of its object is, an int32_t
 * False: out of memory. */
bool rad_drop_covered(const struct rad_job *job, void *list, int32_t *n,
                      size_t size, size_t at);

#endif
