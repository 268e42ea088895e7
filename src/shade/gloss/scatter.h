/* scatter.h - BSDF and aBSDF: scattering by data from XML files
 *
 * What a file holds for a pair of directions (scene/bsdf/bsdf.h) is turned by
 * an up vector, and added to Lambertian parts of the material's own.  Patterns
 * act on all but the scattered reflection. A BSDF of a thickness stands in for
 * geometry that is there as well: eyes and shadow rays see that geometry and
 * not the surface, and scattered light passes by it, starting a thickness
 * deeper. An aBSDF looks for a narrow peak straight ahead: that is followed by
 * one ray, so that one sees through, and cast as a shadow. Source: Radiance's
 * reference manual, "BSDF", "aBSDF"; Ward, Kurt & Bonneel 2012
 * (scene/bsdf/bsdf.h); Ward et al. 2021, Modeling specular transmission of
 * complex fenestration systems with data-driven BSDFs (peak extraction). */
#ifndef RAD_SHADE_SCATTER_H
#define RAD_SHADE_SCATTER_H

#include "trace/material.h"

int rad_scatter_prepare(struct rad_job *job, int32_t index,
                        const struct rad_files *files, const void **data,
                        struct rad_error *err);
bool rad_scatter_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                       struct rad_ray *r);

#endif
