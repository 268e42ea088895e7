/* glass.h - thin panes: one surface stands for both sides of the glass
 *
 * All reflections between the two sides are summed.
 * Source: Ward, Behavior of materials in RADIANCE, "glass"; Radiance's
 * reference manual. */
#ifndef RAD_SHADE_GLASS_H
#define RAD_SHADE_GLASS_H

#include "trace/asks.h"

int rad_glass_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);
bool rad_glass_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r);

#endif
