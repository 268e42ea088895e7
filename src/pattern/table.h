/* table.h - patterns, textures and mixtures by data files and pictures:
 * brightdata, colordata, colorpict, texdata, mixdata, mixpict
 *
 * Expressions give the place to look up (scene/file/data.h), and functions are
 * applied to the values found there.  effect.h applies the results.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_PATTERN_TABLE_H
#define RAD_PATTERN_TABLE_H

#include "trace/material.h"

/* Prepare modifier `index`: *data gets a struct rad_effect.  0 or a code. */
int rad_table_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);

#endif
