/* effect.h - what values do to a ray, as a pattern, a texture or a mixture
 *
 * The values come from functions (func.h), tables (table.h) or spectra
 * (spectral.h).  As in Radiance, if a value cannot be computed, a pattern or a
 * texture has no effect there, and a mixture shades nothing.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_PATTERN_EFFECT_H
#define RAD_PATTERN_EFFECT_H

#include "pattern/expr.h"
#include "trace/material.h"

struct rad_effect;

/* Compute the values at r's hit, one or three; false: one has no value. */
typedef bool rad_effect_fn(struct rad_ctx *ctx, const struct rad_effect *e,
                           const struct rad_ray *r, double value[3]);

/* The first member of the data of a modifier. */
struct rad_effect {
    rad_effect_fn *values;
    rad_effect_fn *colour; /* if the job's channels are not red, green and blue:
                            * computes these, and values() the channels */
    struct rad_expr expr; /* the modifier's expressions and transform */
    int32_t part[2];      /* of a mixture: the two modifiers */
};

/* values() gives red, green and blue: make it give the job's channels.  In a
 * job of red, green and blue nothing changes. */
void rad_effect_channels(const struct rad_job *job, struct rad_effect *e);

bool rad_effect_brighten(struct rad_ctx *ctx, const struct rad_material *mat,
                         struct rad_ray *r);
bool rad_effect_colour(struct rad_ctx *ctx, const struct rad_material *mat,
                       struct rad_ray *r);
bool rad_effect_perturb(struct rad_ctx *ctx, const struct rad_material *mat,
                        struct rad_ray *r);
bool rad_effect_mix(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r);

#endif
