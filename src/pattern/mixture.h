/* mixture.h - what all mixtures do, whatever says how much of each
 *
 * Source: Radiance's reference manual, "Mixtures". */
#ifndef RAD_SHADE_MIXTURE_H
#define RAD_SHADE_MIXTURE_H

#include "trace/material.h"

/* The foreground and the background of mixture `index`, its first two strings:
 * objects, or RAD_VOID for "void". */
int rad_mixture_parts(const struct rad_job *job, int32_t index, int32_t part[2],
                      struct rad_error *err);

/* Shade with the fraction t, made to lie in [0, 1], of the foreground and the
 * rest of the background.  False: neither is a material; then patterns and
 * textures are mixed.  Where only one is, the other lets the ray pass. */
bool rad_mixture_shade(struct rad_ctx *ctx, struct rad_ray *r,
                       const int32_t part[2], double t);

#endif
