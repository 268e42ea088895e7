/* text.h - brighttext, colortext and mixtext: writing as a pattern or mixture
 *
 * Source: Radiance's reference manual, "brighttext". */
#ifndef RAD_PATTERN_TEXT_H
#define RAD_PATTERN_TEXT_H

#include "trace/material.h"

/* Prepare modifier `index`: *data gets a struct text.  0 or a code. */
int rad_text_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err);
bool rad_text_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);
bool rad_text_mix(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r);

#endif
