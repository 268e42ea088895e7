/* brdf.h - plasfunc, metfunc, transfunc and BRTDfunc: gloss by functions;
 * plasdata, metdata and transdata: by data
 *
 * Beside its diffuse part, a surface scatters a light source's radiance by a
 * function of the direction to the source and of its solid angle.  In the
 * function NxP, CrP and the like are the normal and colour that textures and
 * patterns have changed.  It applies to light of sources alone: plasfunc,
 * metfunc and transfunc scatter other light diffusely, and BRTDfunc has
 * expressions for mirrored and transmitted light.  With data the function's
 * first argument is a value of the data file, at a place that other functions
 * of the direction give.
 * Source: Radiance's reference manual. */
#ifndef RAD_SHADE_BRDF_H
#define RAD_SHADE_BRDF_H

#include "trace/material.h"

int rad_brdf_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);

/* The shader of all these types but BRTDfunc. */
bool rad_brdf_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

/* The shader of BRTDfunc. */
bool rad_brtd_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

#endif
