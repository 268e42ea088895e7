/* prism.h - prism1 and prism2: surfaces that send rays on in other directions
 *
 * A prism has one or two ways: for each, expressions give a coefficient and the
 * direction in which a ray goes on from the surface.  Flat prisms relay light
 * sources as mirrors do (light/direct/virtual.h).  In the expressions DxA, DyA,
 * DzA is the direction to the relayed source for a shadow ray to it, and a zero
 * vector for all other rays.
 * Source: Radiance's reference manual, "prism1". */
#ifndef RAD_SHADE_PRISM_H
#define RAD_SHADE_PRISM_H

#include "trace/asks.h"

int rad_prism_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);
bool rad_prism_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r);

#endif
