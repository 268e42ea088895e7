/* func.c - see func.h */
#include "config.h"

#include "shade/func.h"
#include "base/vec.h"
#include "shade/expr.h"
#include "shade/mixture.h"

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
    if (rc == 0 && o->type == RAD_MIXFUNC)
        rc = rad_mixture_parts(job, index, f->part, err);
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

bool
rad_func_mix(struct rad_ctx *ctx, const struct rad_material *mat,
             struct rad_ray *r)
{
    const struct func *f = mat->data;
    double v[3];

    return evaluate(ctx, f, r, v) && rad_mixture_shade(ctx, r, f->part, v[0]);
}
