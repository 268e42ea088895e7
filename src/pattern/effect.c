/* effect.c - see effect.h */
#include "config.h"

#include "pattern/effect.h"
#include "base/vec.h"
#include "pattern/mixture.h"

static bool
channels(struct rad_ctx *ctx, const struct rad_effect *e,
         const struct rad_ray *r, double value[3])
{
    const uint8_t *primary = ctx->job->primary;
    double rgb[3];

    if (!e->colour(ctx, e, r, rgb))
        return false;
    for (int k = 0; k < 3; k++)
        value[k] = rgb[primary[k]];
    return true;
}

void
rad_effect_channels(const struct rad_job *job, struct rad_effect *e)
{
    if (rad_bands_are_rgb(&job->params.bands))
        return;
    e->colour = e->values;
    e->values = channels;
}

bool
rad_effect_brighten(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r)
{
    const struct rad_effect *e = mat->data;
    double v[3];

    if (e->values(ctx, e, r, v))
        r->pattern = rad_rgb_scale(r->pattern, v[0]);
    return false;
}

bool
rad_effect_colour(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r)
{
    const struct rad_effect *e = mat->data;
    double v[3];

    if (e->values(ctx, e, r, v))
        r->pattern = rad_rgb_mul(
            r->pattern, rad_rgb((float)v[0], (float)v[1], (float)v[2]));
    return false;
}

bool
rad_effect_perturb(struct rad_ctx *ctx, const struct rad_material *mat,
                   struct rad_ray *r)
{
    const struct rad_effect *e = mat->data;
    double v[3];

    if (e->values(ctx, e, r, v)) {
        rad_expr_outward(&e->expr, r, v);
        rad_madd(r->pert, r->pert, 1, v);
    }
    return false;
}

bool
rad_effect_mix(struct rad_ctx *ctx, const struct rad_material *mat,
               struct rad_ray *r)
{
    const struct rad_effect *e = mat->data;
    double v[3];

    return e->values(ctx, e, r, v) && rad_mixture_shade(ctx, r, e->part, v[0]);
}
