/* func.c - see func.h */
#include "config.h"

#include "shade/func.h"
#include "base/vec.h"
#include "shade/expr.h"

#include <string.h>

struct func {
    struct rad_expr expr;
    int32_t part[2]; /* modifiers that a mixture mixes */
};

/* Where the string arguments of a type are. */
static const struct layout {
    enum rad_otype type;
    unsigned exprs; /* bit by string */
    int file;
} layouts[] = {
    { RAD_BRIGHTFUNC, 01, 1 },
    { RAD_COLORFUNC, 07, 3 },
    { RAD_TEXFUNC, 07, 3 },
    { RAD_MIXFUNC, 04, 3 },
};

static const struct layout *
find_layout(enum rad_otype type)
{
    for (size_t i = 0; i < sizeof layouts / sizeof layouts[0]; i++)
        if (layouts[i].type == type)
            return &layouts[i];
    return NULL;
}

static int
find_parts(const struct rad_job *job, int32_t index, struct func *f,
           struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];

    f->part[0] = f->part[1] = RAD_VOID;
    if (o->type != RAD_MIXFUNC)
        return 0;
    for (int i = 0; i < 2; i++) {
        if (strcmp(o->strings[i], "void") == 0)
            continue;
        f->part[i] = rad_scene_find_modifier(job->scene, o->strings[i], index);
        if (f->part[i] == RAD_VOID)
            return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                                  "undefined modifier '%s'", o->strings[i]);
    }
    return 0;
}

int
rad_func_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    const struct layout *at = find_layout(o->type);
    struct func *f = rad_arena_calloc(&job->arena, 1, sizeof *f);
    int rc;

    if (!f)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = rad_expr_prepare(job, o, files, at->file, at->exprs, &f->expr, err);
    if (rc == 0)
        rc = find_parts(job, index, f, err);
    *data = f;
    return rc;
}

/* The values of all its expressions; false: one cannot be worked out. */
static bool
evaluate(struct rad_ctx *ctx, const struct func *f, const struct rad_ray *r,
         double value[3])
{
    return rad_expr_values(ctx, &f->expr, r, 0, f->expr.n, value);
}

bool
rad_func_brighten(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r)
{
    double v[3];

    if (evaluate(ctx, mat->data, r, v))
        r->pattern = rad_rgb_scale(r->pattern, (float)v[0]);
    return false;
}

bool
rad_func_colour(struct rad_ctx *ctx, const struct rad_material *mat,
                struct rad_ray *r)
{
    double v[3];

    if (evaluate(ctx, mat->data, r, v))
        r->pattern = rad_rgb_mul(
            r->pattern, rad_rgb((float)v[0], (float)v[1], (float)v[2]));
    return false;
}

bool
rad_func_perturb(struct rad_ctx *ctx, const struct rad_material *mat,
                 struct rad_ray *r)
{
    const struct func *f = mat->data;
    double v[3];

    if (evaluate(ctx, f, r, v)) {
        rad_expr_outward(&f->expr, r, v);
        rad_madd(r->pert, r->pert, 1, v);
    }
    return false;
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

/* Where only one part is a material, the other lets the ray pass. */
bool
rad_func_mix(struct rad_ctx *ctx, const struct rad_material *mat,
             struct rad_ray *r)
{
    const struct func *f = mat->data;
    struct rad_ray fore = *r, back = *r;
    bool fore_mat, back_mat;
    double v[3], t;

    if (!evaluate(ctx, f, r, v))
        return false;
    t = fmin(fmax(v[0], 0), 1);
    fore_mat = shade_part(ctx, &fore, f->part[0], t);
    back_mat = shade_part(ctx, &back, f->part[1], 1 - t);
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
