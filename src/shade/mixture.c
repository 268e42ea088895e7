/* mixture.c - see mixture.h */
#include "config.h"

#include "shade/mixture.h"
#include "base/vec.h"

#include <math.h>
#include <string.h>

int
rad_mixture_parts(const struct rad_job *job, int32_t index, int32_t part[2],
                  struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];

    part[0] = part[1] = RAD_VOID;
    for (int i = 0; i < 2; i++) {
        if (strcmp(o->strings[i], "void") == 0)
            continue;
        part[i] = rad_scene_find_modifier(job->scene, o->strings[i], index);
        if (part[i] == RAD_VOID)
            return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                                  "undefined modifier '%s'", o->strings[i]);
    }
    return 0;
}

static struct rad_rgb
mix(struct rad_rgb a, struct rad_rgb b, double t)
{
    return rad_rgb_add(rad_rgb_scale(a, (float)t),
                       rad_rgb_scale(b, (float)(1 - t)));
}

/* The part of r's light that one modifier gives.  True: it is a material. */
static bool
shade_part(struct rad_ctx *ctx, struct rad_ray *part, int32_t mod, double coef)
{
    if (!(coef > RAD_TINY))
        return false;
    part->weight *= (float)coef;
    part->coef = rad_rgb_scale(part->coef, (float)coef);
    return rad_ray_shade(ctx, part, mod);
}

/* Light and distances of a mixture of two materials, the fraction t of fore:
 * the distances are of the brighter part. */
static void
mix_light(struct rad_ray *r, const struct rad_ray *fore,
          const struct rad_ray *back, double t)
{
    float s = (float)t;
    float fm = s * rad_rgb_lum(fore->L_mirror);
    float bm = (1 - s) * rad_rgb_lum(back->L_mirror);
    float fd = s * rad_rgb_lum(fore->L) - fm;
    float bd = (1 - s) * rad_rgb_lum(back->L) - bm;

    r->L = mix(fore->L, back->L, t);
    r->L_mirror = mix(fore->L_mirror, back->L_mirror, t);
    r->mirror_dist = fm > bm ? fore->mirror_dist : back->mirror_dist;
    r->dist = fd > bd ? fore->dist : back->dist;
}

bool
rad_mixture_shade(struct rad_ctx *ctx, struct rad_ray *r, const int32_t part[2],
                  double t)
{
    struct rad_ray fore = *r, back = *r;
    bool fore_mat, back_mat;

    t = rad_least(rad_most(t, 0), 1);
    fore_mat = shade_part(ctx, &fore, part[0], t);
    back_mat = shade_part(ctx, &back, part[1], 1 - t);
    if (back_mat && !fore_mat && t > RAD_TINY)
        rad_ray_transmit(ctx, &fore);
    else if (fore_mat && !back_mat && 1 - t > RAD_TINY)
        rad_ray_transmit(ctx, &back);
    for (int i = 0; i < 3; i++)
        r->pert[i] = t * fore.pert[i] + (1 - t) * back.pert[i];
    r->pattern = mix(fore.pattern, back.pattern, t);
    if (!fore_mat && !back_mat)
        return false;
    mix_light(r, &fore, &back, t);
    return true;
}
