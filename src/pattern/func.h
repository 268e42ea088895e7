/* func.h - patterns, textures and mixtures by functions: colorfunc,
 * brightfunc, texfunc, mixfunc
 *
 * The values are those of the modifier's expressions (expr.h); effect.h applies
 * them.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_PATTERN_FUNC_H
#define RAD_PATTERN_FUNC_H

#include "trace/material.h"

/* Prepare modifier `index`: *data gets a struct rad_effect.  0 or a code. */
int rad_func_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);

#endif
