/* ashik.h - ashik2: the anisotropic Phong model of Ashikhmin and Shirley
 *
 * A diffuse base under gloss.  The highlight falls off by one power of the
 * cosine along a vector u, which three expressions give, and by another power
 * across it.  Toward grazing the gloss grows and the base dims, by Schlick's
 * approximation of Fresnel's formula.  As in Radiance, the base dims by the
 * light's angle alone, the gloss grows by the eye's angle alone, and -ss below
 * 1 does not narrow the samples.
 * Source: Ashikhmin & Shirley 2000, An anisotropic Phong BRDF model; Schlick
 * 1994; Radiance's reference manual, "ashik2". */
#ifndef RAD_SHADE_ASHIK_H
#define RAD_SHADE_ASHIK_H

#include "trace/material.h"

int rad_ashik_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);
bool rad_ashik_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r);

#endif
