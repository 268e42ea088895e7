/* mixture.c - see mixture.h */
#include "config.h"

#include "pattern/mixture.h"
#include "base/vec.h"

int
rad_mixture_parts(const struct rad_job *job, int32_t index, int32_t part[2],
                  struct rad_error *err)
{
    int rc = rad_scene_named(job->scene, index, 0, &part[0], err);

    if (rc == 0)
        rc = rad_scene_named(job->scene, index, 1, &part[1], err);
    return rc;
}

static struct rad_rgb
mix(struct rad_rgb a, struct rad_rgb b, double t)
{
    return rad_rgb_add(rad_rgb_scale(a, t), rad_rgb_scale(b, 1 - t));
}

/* Shade `part`, a copy of the ray, with one modifier, whose share is coef.
 * True: it is a material. */
static bool
shade_part(struct rad_ctx *ctx, struct rad_ray *part, int32_t mod, double coef)
{
    if (!(coef > RAD_TINY))
        return false;
    part->weight *= (float)coef;
    part->coef = rad_rgb_scale(part->coef, coef);
    return rad_ray_shade(ctx, part, mod);
}

/* Mix light and distances of two materials, the fraction t of the foreground,
 * which is r itself.  The distances are those of the brighter part. */
static void
mix_light(struct rad_ray *r, const struct rad_ray *back, double t)
{
    float s = (float)t;
    float fm = s * rad_rgb_lum(r->L_mirror);
    float bm = (1 - s) * rad_rgb_lum(back->L_mirror);
    float fd = s * rad_rgb_lum(r->L) - fm;
    float bd = (1 - s) * rad_rgb_lum(back->L) - bm;

    r->L = mix(r->L, back->L, t);
    r->L_mirror = mix(r->L_mirror, back->L_mirror, t);
    if (!(fm > bm))
        r->mirror_dist = back->mirror_dist;
    if (!(fd > bd))
        r->dist = back->dist;
}

/* Shade r with one modifier alone, as where a function chooses between two.
 * The result is the same as mixing with a black part that has r's old
 * distances: if the material is black, too, the second part's distances
 * count. */
static bool
shade_whole(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod, bool second)
{
    double dist = r->dist, mirror_dist = r->mirror_dist;
    float fm;

    if (!rad_ray_shade(ctx, r, mod))
        return false;
    if (second)
        return true;
    fm = rad_rgb_lum(r->L_mirror);
    if (!(fm > 0))
        r->mirror_dist = mirror_dist;
    if (!(rad_rgb_lum(r->L) - fm > 0))
        r->dist = dist;
    return true;
}

/* A mist may have charged its part of the ray for absorption on the way
 * (mist.c) and the other material not.  Since they become one ray, charge the
 * other part as well. */
static void
charge_alike(struct rad_ctx *ctx, struct rad_ray *r, struct rad_ray *back)
{
    bool charged = rad_rgb_black(r->ext);

    if (charged == rad_rgb_black(back->ext))
        return;
    rad_ray_absorb(ctx, charged ? back : r);
    r->ext = rad_grey(0);
}

/* r serves as its own first part, since a ray has some 400 bytes. */
bool
rad_mixture_shade(struct rad_ctx *ctx, struct rad_ray *r, const int32_t part[2],
                  double t)
{
    struct rad_rgb coef = r->coef;
    float weight = r->weight;
    struct rad_ray back;
    bool fore_mat, back_mat;

    t = rad_least(rad_most(t, 0), 1);
    if (t == 0 || t == 1)
        return shade_whole(ctx, r, part[t == 0], t == 0);
    back = *r;
    fore_mat = shade_part(ctx, r, part[0], t);
    back_mat = shade_part(ctx, &back, part[1], 1 - t);
    if (back_mat && !fore_mat && t > RAD_TINY)
        rad_ray_transmit(ctx, r);
    else if (fore_mat && !back_mat && 1 - t > RAD_TINY)
        rad_ray_transmit(ctx, &back);
    r->weight = weight;
    r->coef = coef;
    for (int i = 0; i < 3; i++)
        r->pert[i] = t * r->pert[i] + (1 - t) * back.pert[i];
    r->pattern = mix(r->pattern, back.pattern, t);
    if (!fore_mat && !back_mat)
        return false;
    charge_alike(ctx, r, &back);
    mix_light(r, &back, t);
    return true;
}
