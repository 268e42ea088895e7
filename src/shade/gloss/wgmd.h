/* wgmd.h - WGMDfunc: gloss and mirror by expressions, with modifiers for each
 * part of the light
 *
 * What is reflected and what is passed specularly have each a modifier, a
 * coefficient and two roughnesses, all by expressions; with a roughness of 0
 * the part is a mirror's or passes unbent, else its lobe is that of plastic2
 * and its like (gloss.h).  What is reflected and passed diffusely is given by
 * numbers, different for front and back.  Where a mirror reflects more than
 * .018, it brightens toward grazing by an approximation of Fresnel's formula,
 * and the rest dims.
 * A modifier of "inherit" is the material's own, which the diffuse reflection
 * always has.
 * Source: Radiance's reference manual, "WGMDfunc"; the papers of gloss.h. */
#ifndef RAD_SHADE_WGMD_H
#define RAD_SHADE_WGMD_H

#include "trace/material.h"

int rad_wgmd_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);
bool rad_wgmd_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

#endif
