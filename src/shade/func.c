/* func.c - see func.h
 *
 * All functions of a scene share one program (job->calc), made when the first
 * is met; each thread has an evaluator of it (ctx->calc).  A function file is
 * read once, into a context named after it. */
#include "config.h"

#include "shade/func.h"
#include "base/vec.h"
#include "base/xform.h"
#include "scene/calc.h"

#include <stdlib.h>
#include <string.h>

#define FAR 1e10 /* how far away Radiance takes distant sources to be */

struct func {
    int32_t nexprs;
    int expr[3];
    int32_t part[2];       /* modifiers that a mixture mixes */
    struct rad_xform move; /* from the function's coordinates to the world's */
    struct rad_xform back;
    const double *args;
    int nargs;
};

/* Where the string arguments of a type are. */
static const struct layout {
    enum rad_otype type;
    int first, nexprs; /* expressions */
    int file;
} layouts[] = {
    { RAD_BRIGHTFUNC, 0, 1, 1 },
    { RAD_COLORFUNC, 0, 3, 3 },
    { RAD_TEXFUNC, 0, 3, 3 },
    { RAD_MIXFUNC, 2, 1, 3 },
};

static const struct layout *
find_layout(enum rad_otype type)
{
    for (size_t i = 0; i < sizeof layouts / sizeof layouts[0]; i++)
        if (layouts[i].type == type)
            return &layouts[i];
    return NULL;
}

/* Read a function file, unless it has been; returns its context. */
static int
load(struct rad_job *job, const struct rad_object *o,
     const struct rad_files *files, const char *name, struct rad_error *err)
{
    struct rad_error why = { 0 };
    int context, rc;
    size_t len;
    char *text;

    if (!job->calc && !(job->calc = rad_calc_new(err)))
        return RAD_ENOMEM;
    context = rad_calc_context(job->calc, name, err);
    if (context < 0 || rad_calc_loaded(job->calc, context))
        return context;
    rc = rad_material_file(job, o, files, name, &text, &len, err);
    if (rc)
        return rc;
    rc = rad_calc_read(job->calc, context, name, text, len, &why);
    free(text);
    return rc ? rad_material_file_fail(job, o, name, &why, err) : context;
}

static int
compile_expressions(struct rad_job *job, const struct rad_object *o,
                    const struct layout *at, int context, struct func *f,
                    struct rad_error *err)
{
    f->nexprs = at->nexprs;
    for (int i = 0; i < at->nexprs; i++) {
        const char *text = o->strings[at->first + i];
        struct rad_error why = { 0 };

        f->expr[i] = rad_calc_expression(job->calc, context, text, &why);
        if (f->expr[i] < 0)
            return rad_material_file_fail(job, o, text, &why, err);
    }
    return 0;
}

/* The transform starts at the first word that may, behind the file. */
static int
read_transform(const struct rad_job *job, const struct rad_object *o,
               const struct layout *at, struct func *f, struct rad_error *err)
{
    struct rad_error why = { 0 };
    int i = at->file + 1;

    while (i < o->nstrings && !rad_xform_starts(o->strings[i]))
        i++;
    if (rad_xform_parse(&f->move, o->strings + i, o->nstrings - i, &why))
        return rad_scene_fail(job->scene, o, err, why.code, "%s", why.what);
    rad_xform_invert(&f->back, &f->move);
    return 0;
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
    struct func *f;
    int context, rc;

    if (!at || o->nstrings <= at->file)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "too few string arguments");
    f = rad_arena_calloc(&job->arena, 1, sizeof *f);
    if (!f)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    f->args = o->reals;
    f->nargs = o->nreals;
    context = load(job, o, files, o->strings[at->file], err);
    if (context < 0)
        return context;
    rc = compile_expressions(job, o, at, context, f, err);
    if (rc == 0)
        rc = read_transform(job, o, at, f, err);
    if (rc == 0)
        rc = find_parts(job, index, f, err);
    *data = f;
    return rc;
}

/* --- what expressions see of a ray ---------------------------------------- */

static double
length(const struct rad_ray *r)
{
    return r->hit.t < FAR ? r->hit.t : FAR;
}

/* Length of the ray and its ancestors, as long as their path is of a kind. */
static double
way(const struct rad_ray *r, unsigned kind)
{
    double sum = 0;

    for (; r && r->path & kind; r = r->parent)
        sum += length(r);
    return sum;
}

/* Channels $1 to $27, in the order that calcinit.c names them. */
static void
set_channels(double c[RAD_CALC_NCHANNELS], const struct func *f,
             const struct rad_ray *r)
{
    const struct rad_xform *b = &f->back;
    double p[3];

    rad_copy(p, r->hit.p);
    if (!(r->hit.t < INFINITY))
        rad_madd(p, r->org, FAR, r->dir);
    rad_xform_vector(c, b, r->dir);
    rad_scale(c, 1 / b->scale, c);
    rad_xform_vector(c + 3, b, r->n);
    rad_scale(c + 3, 1 / b->scale, c + 3);
    rad_xform_point(c + 6, b, p);
    c[9] = way(r, RAD_RAY_PRIMARY) * b->scale;
    c[10] = fmin(fmax(r->cos_o, -1), 1);
    c[11] = b->scale;
    rad_copy(c + 12, b->t);
    for (int i = 0; i < 3; i++)
        rad_scale(c + 15 + 3 * i, 1 / b->scale, b->m[i]);
    c[24] = (length(r) + way(r->parent, RAD_RAY_SHADOW)) * b->scale;
    c[25] = r->hit.uv[0];
    c[26] = r->hit.uv[1];
}

/* The values of a function's expressions; false: one cannot be worked out. */
static bool
evaluate(struct rad_ctx *ctx, const struct func *f, const struct rad_ray *r,
         double value[3])
{
    double channel[RAD_CALC_NCHANNELS];
    struct rad_calc_input in = { channel, f->args, f->nargs };

    set_channels(channel, f, r);
    rad_calc_begin(ctx->calc, &in);
    for (int i = 0; i < f->nexprs; i++) {
        enum rad_calc_fault fault;

        value[i] = rad_calc_eval(ctx->job->calc, f->expr[i], ctx->calc, &fault);
        if (fault || !isfinite(value[i]))
            return false;
    }
    return true;
}

/* --- what they do ----------------------------------------------------------
 */

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
        rad_xform_vector(v, &f->move, v);
        rad_madd(r->pert, r->pert, 1 / f->move.scale, v);
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
