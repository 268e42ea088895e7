/* dielectric.h - bodies that refract: dielectric and interface
 *
 * Fresnel's formulas and Snell's law at the surface, absorption by length
 * within.  The index of refraction is n + h/500 for Hartmann's constant h and
 * light of 500 nm; colours are not spread.
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
