/* mirror.h - mirrors that relay light sources
 *
 * A mirror is a surface of one colour that reflects one ray, and shows light
 * sources to direct light (light/direct/virtual.h).  One string argument names a
 * material that all other rays see in its place.
 * Source: Radiance's reference manual, "mirror". */
#ifndef RAD_SHADE_MIRROR_H
#define RAD_SHADE_MIRROR_H

#include "trace/asks.h"

int rad_mirror_prepare(struct rad_job *job, int32_t index,
                       const struct rad_files *files, const void **data,
                       struct rad_error *err);
bool rad_mirror_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                      struct rad_ray *r);

#endif
