/* brdf.h - plasfunc, metfunc, transfunc and BRTDfunc: gloss by functions;
 * plasdata, metdata and transdata: by data
 *
 * How much of a light source's radiance a surface scatters beside its diffuse
 * part is a function of the direction to the source and of its solid angle,
 * which sees the surface as textures and patterns have made it (NxP, CrP and
 * their like).  It knows the light of sources alone: what else shines on
 * plasfunc, metfunc and transfunc is scattered evenly, and BRTDfunc has
 * expressions for what it mirrors and lets pass.  With data the function is
 * applied to what stands where other functions of the direction point.
 * Source: Radiance's reference manual. */
#ifndef RAD_SHADE_BRDF_H
#define RAD_SHADE_BRDF_H

#include "trace/material.h"

int rad_brdf_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);

/* all but BRTDfunc */
bool rad_brdf_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

/* BRTDfunc */
bool rad_brtd_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

#endif
