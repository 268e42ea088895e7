/* effect.h - what a value does as a pattern, a texture or a mixture, whether a
 * function (func.h) or a table (table.h) gives it
 *
 * A value that cannot be worked out leaves a pattern or texture without effect
 * there, and a mixture without either of its parts, as in Radiance.
 * Source: Radiance's reference manual, "Patterns", "Textures", "Mixtures". */
#ifndef RAD_SHADE_EFFECT_H
#define RAD_SHADE_EFFECT_H

#include "pattern/expr.h"
#include "trace/material.h"

struct rad_effect;

/* The values at r's hit, one or three; false: one cannot be worked out. */
typedef bool rad_effect_fn(struct rad_ctx *ctx, const struct rad_effect *e,
                           const struct rad_ray *r, double value[3]);

/* The first member of what a modifier's prepare function makes. */
struct rad_effect {
    rad_effect_fn *values;
    rad_effect_fn *colour; /* red, green and blue, where values() gives other
                            * channels; else NULL */
    struct rad_expr expr; /* its expressions; their place is the texture's */
    int32_t part[2];      /* modifiers that a mixture mixes */
};

/* What values() gives is red, green and blue: have it give what the job's
 * channels show.  Nothing changes where these are the same. */
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
