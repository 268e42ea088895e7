/* table.h - patterns, textures and mixtures by data files and pictures:
 * brightdata, colordata, colorpict, texdata, mixdata, mixpict
 *
 * Expressions give the place that is looked up (scene/data.h); functions are
 * applied to what is found there.  A value that cannot be worked out leaves a
 * pattern or texture without effect, and a mixture without either of its parts,
 * as in Radiance.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_SHADE_TABLE_H
#define RAD_SHADE_TABLE_H

#include "shade/material.h"

int rad_table_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);
bool rad_table_brighten(struct rad_ctx *ctx, const struct rad_material *mat,
                        struct rad_ray *r);
bool rad_table_colour(struct rad_ctx *ctx, const struct rad_material *mat,
                      struct rad_ray *r);
bool rad_table_perturb(struct rad_ctx *ctx, const struct rad_material *mat,
                       struct rad_ray *r);
bool rad_table_mix(struct rad_ctx *ctx, const struct rad_material *mat,
                   struct rad_ray *r);

#endif
