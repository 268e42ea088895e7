/* antimatter.h - surfaces that cut holes in other surfaces
 *
 * Within a closed surface of antimatter, surfaces of the modifiers that it
 * names are not there.  If the first name is a material's, and the ray is
 * inside a solid of the named modifiers, the cut shows that material.
 * Source: Radiance's reference manual, "antimatter". */
#ifndef RAD_SHADE_ANTIMATTER_H
#define RAD_SHADE_ANTIMATTER_H

#include "trace/asks.h"

int rad_antimatter_prepare(struct rad_job *job, int32_t index,
                           const struct rad_files *files, const void **data,
                           struct rad_error *err);
bool rad_antimatter_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                          struct rad_ray *r);

#endif
