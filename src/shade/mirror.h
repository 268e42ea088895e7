/* mirror.h - mirrors that relay light sources
 *
 * A mirror has one colour and reflects one ray.  It relays shadow rays to the
 * images of light sources in it (light/direct/virtual.h).  A string argument
 * names an alternate material, which all other rays see in its place.
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
