/* table.h - patterns, textures and mixtures by data files and pictures:
 * brightdata, colordata, colorpict, texdata, mixdata, mixpict
 *
 * Expressions give the place that is looked up (scene/file/data.h); functions
 * are applied to what is found there.  What is prepared is shaded by effect.h.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_SHADE_TABLE_H
#define RAD_SHADE_TABLE_H

#include "trace/material.h"

int rad_table_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);

#endif
