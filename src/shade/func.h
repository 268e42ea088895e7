/* func.h - patterns, textures and mixtures by functions: colorfunc,
 * brightfunc, texfunc, mixfunc
 *
 * Their expressions see the ray and the surface in the coordinates that their
 * transform moves into place, and their own real arguments.  A value that
 * cannot be worked out leaves a pattern or texture without effect there, and a
 * mixture without either of its parts, as in Radiance.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_SHADE_FUNC_H
#define RAD_SHADE_FUNC_H

#include "shade/material.h"

int rad_func_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);
bool rad_func_brighten(struct rad_ctx *ctx, const struct rad_material *mat,
                       struct rad_ray *r);
bool rad_func_colour(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r);
bool rad_func_perturb(struct rad_ctx *ctx, const struct rad_material *mat,
                      struct rad_ray *r);
bool rad_func_mix(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r);

#endif
