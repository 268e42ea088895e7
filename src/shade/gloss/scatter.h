/* scatter.h - BSDF and aBSDF: scattering by data from XML files
 *
 * A file has values for pairs of directions (scene/bsdf/bsdf.h).  They are
 * oriented by an up vector, and added to diffuse parts that the material's
 * arguments give.  Patterns apply to all but the scattered reflection.
 * A BSDF with a thickness stands for geometry that the scene has as well: view
 * rays and shadow rays see that geometry, not the surface; scattered rays that
 * pass through start a thickness deeper, behind the geometry.
 * An aBSDF looks for a narrow peak straight ahead, which is traced by one ray:
 * so one can see through it, and it casts a sharp shadow.
 * Sources: Radiance's reference manual, "BSDF", "aBSDF"; Ward, Kurt & Bonneel
 * 2012 (scene/bsdf/bsdf.h); Ward et al. 2021, Modeling specular transmission of
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
