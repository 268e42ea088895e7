/* effect.c - see effect.h */
#include "config.h"

#include "pattern/effect.h"
#include "base/vec.h"
#include "pattern/mixture.h"

bool
rad_effect_brighten(struct rad_ctx *ctx, const struct rad_material *mat,
                    struct rad_ray *r)
{
    const struct rad_effect *e = mat->data;
    double v[3];

    if (e->values(ctx, e, r, v))
        r->pattern = rad_rgb_scale(r->pattern, (float)v[0]);
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
