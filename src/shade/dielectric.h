/* dielectric.h - solids that refract: dielectric and interface
 *
 * Fresnel's formulas and Snell's law at the surface, absorption along the way
 * within.  The index of refraction is n + h/500, with Hartmann's constant h,
 * for light of 500 nm; there is no dispersion.
 * Source: Radiance's reference manual, "dielectric" and "interface". */
#ifndef RAD_SHADE_DIELECTRIC_H
#define RAD_SHADE_DIELECTRIC_H

#include "trace/material.h"

int rad_dielectric_prepare(struct rad_job *job, int32_t index,
                           const struct rad_files *files, const void **data,
                           struct rad_error *err);
bool rad_dielectric_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                          struct rad_ray *r);

#endif
