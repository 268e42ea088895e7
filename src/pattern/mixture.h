/* mixture.h - mixing two modifiers, whatever determines their shares
 *
 * Source: Radiance's reference manual, "Mixtures". */
#ifndef RAD_PATTERN_MIXTURE_H
#define RAD_PATTERN_MIXTURE_H

#include "trace/material.h"

/* The foreground and background of mixture `index`, named by its first two
 * strings: objects, or RAD_VOID for "void".  0 or a code. */
int rad_mixture_parts(const struct rad_job *job, int32_t index, int32_t part[2],
                      struct rad_error *err);

/* Shade r with the fraction t, cut to [0, 1], of the foreground, and the rest
 * of the background.  If only one of them is a material, the other lets the ray
 * pass.  False: neither is a material; then their patterns and textures are
 * mixed. */
bool rad_mixture_shade(struct rad_ctx *ctx, struct rad_ray *r,
                       const int32_t part[2], double t);

#endif
