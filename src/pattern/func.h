/* func.h - patterns, textures and mixtures by functions: colorfunc,
 * brightfunc, texfunc, mixfunc
 *
 * Their expressions see the ray and the surface in the coordinates that their
 * transform moves into place, and their own real arguments.  What is prepared
 * is shaded by effect.h.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_SHADE_FUNC_H
#define RAD_SHADE_FUNC_H

#include "trace/material.h"

int rad_func_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);

#endif
