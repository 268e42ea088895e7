/* wgmd.h - WGMDfunc: gloss and mirror by expressions, with a modifier for each
 * part of the light
 *
 * The specular reflection and the specular transmission have each a modifier,
 * and by expressions a coefficient and two roughnesses.  With a roughness of 0
 * the part is mirrored, or passes unbent; else it has the lobe of plastic2 and
 * its like (gloss.h).  The diffuse parts are numbers; the reflection has one
 * for the front and one for the back.  A mirror that reflects more than .018
 * brightens toward grazing by an approximation of Fresnel's formula, and the
 * other parts dim.
 * The modifier "inherit" is the material's own, which diffuse reflection always
 * has.
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
