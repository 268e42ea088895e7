/* expr.c - see expr.h */
#include "config.h"

#include "pattern/expr.h"
#include "base/vec.h"

#include <assert.h>
#include <stdlib.h>

#define FAR 1e10 /* length of a ray to a distant source, as in Radiance */

/* --- compiling ------------------------------------------------------------ */

/* Read a function file, unless it is read already; returns its context. */
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

/* Refuse an expression that needs real arguments which the object does not
 * have, or that calls a function with too few arguments: rpict ends at such a
 * call. */
static int
check_needs(const struct rad_job *job, const struct rad_object *o,
            const struct rad_calc_need *need, struct rad_error *err)
{
    if (need->reals > o->nreals)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "missing real argument %d", need->reals);
    if (need->function)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "too few arguments for %s()", need->function);
    return 0;
}

static int
compile_expressions(struct rad_job *job, const struct rad_object *o,
                    unsigned which, struct rad_expr *e, struct rad_error *err)
{
    e->n = 0;
    e->numbers = 0;
    e->channels = 0;
    for (int i = 0; which >> i; i++) {
        struct rad_error why = { 0 };
        struct rad_calc_compiled c;

        if (!(which >> i & 1))
            continue;
        if (rad_calc_compile(job->calc, e->context, o->strings[i], &c, &why) <
            0)
            return rad_material_file_fail(job, o, o->strings[i], &why, err);
        if (check_needs(job, o, &c.need, err) < 0)
            return RAD_EDATA;
        e->number[e->n] = c.number;
        if (c.is_number)
            e->numbers |= 1u << e->n;
        e->channels |= c.channels;
        e->code[e->n++] = c.code;
    }
    return 0;
}

/* Read the transform, which begins with the first word after the file's name
 * that can begin one. */
static int
read_transform(const struct rad_job *job, const struct rad_object *o, int file,
               struct rad_expr *e, struct rad_error *err)
{
    struct rad_error why = { 0 };
    int i = file + 1;

    while (i < o->nstrings && !rad_xform_starts(o->strings[i]))
        i++;
    if (rad_xform_parse(&e->move, o->strings + i, o->nstrings - i, &why))
        return rad_scene_fail(job->scene, o, err, why.code, "%s", why.what);
    rad_xform_invert(&e->back, &e->move);
    return 0;
}

/* Groups of variables that a type has beyond the standard ones. */
static unsigned
offer_of(enum rad_otype type)
{
    switch (type) {
    case RAD_PLASFUNC:
    case RAD_METFUNC:
    case RAD_TRANSFUNC:
    case RAD_PLASDATA:
    case RAD_METDATA:
    case RAD_TRANSDATA:
    case RAD_BRTDFUNC:
        return RAD_CALC_OFFER_NORMAL | RAD_CALC_OFFER_COLOR;
    case RAD_WGMDFUNC:
        return RAD_CALC_OFFER_NORMAL;
    case RAD_PRISM1:
    case RAD_PRISM2:
        return RAD_CALC_OFFER_AIM;
    default:
        return 0;
    }
}

int
rad_expr_prepare(struct rad_job *job, const struct rad_object *o,
                 const struct rad_files *files, unsigned which,
                 struct rad_expr *e, struct rad_error *err)
{
    int file = rad_otype_files(o->type).function, rc;

    assert(file >= 0); /* reach.c has the type */
    /* nstrings may be 32 or more, for which the shift is undefined */
    if (o->nstrings <= file || (o->nstrings < 32 && which >> o->nstrings))
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "too few string arguments");
    e->object = (int32_t)(o - job->scene->objects);
    e->args = o->reals;
    e->nargs = o->nreals;
    e->context = load(job, o, files, o->strings[file], err);
    if (e->context < 0)
        return e->context;
    rad_calc_offer(job->calc, offer_of(o->type));
    rc = compile_expressions(job, o, which, e, err);
    return rc ? rc : read_transform(job, o, file, e, err);
}

int
rad_expr_function(struct rad_job *job, const struct rad_object *o,
                  struct rad_expr *e, int which, int n, struct rad_error *err)
{
    const char *name = o->strings[which];
    struct rad_error why = { 0 };
    int f;

    rad_calc_offer(job->calc, offer_of(o->type));
    f = rad_calc_function(job->calc, e->context, name, n, &why);
    if (f >= 0)
        e->channels |= rad_calc_channels(job->calc, f);
    return f < 0 ? rad_material_file_fail(job, o, name, &why, err) : f;
}

/* --- what expressions see of a ray ---------------------------------------- */

static double
length(const struct rad_ray *r)
{
    return r->hit.t < FAR ? r->hit.t : FAR;
}

/* The length of the ray and its ancestors, as long as they are of this kind. */
static double
way(const struct rad_ray *r, unsigned kind)
{
    double sum = 0;

    for (; r && r->path & kind; r = r->parent)
        sum += length(r);
    return sum;
}

/* Index of the channels of the axes' directions. */
#define AXES 15

/* Channels that are set together, as bits. */
#define RAYS_WAY   UINT64_C(07)
#define NORMAL     UINT64_C(070)
#define POINT      UINT64_C(0700)
#define WAY        (UINT64_C(1) << 9)
#define SHADOW_WAY (UINT64_C(1) << 24)

static void
turn_inward(const double c[RAD_CALC_NCHANNELS], const double v[3], double w[3])
{
    for (int k = 0; k < 3; k++)
        w[k] = v[0] * c[AXES + k] + v[1] * c[AXES + 3 + k] +
               v[2] * c[AXES + 6 + k];
}

void
rad_expr_inward(const struct rad_expr_scope *scope, const double v[3],
                double w[3])
{
    turn_inward(scope->channel, v, w);
}

/* Set the channels of a transform: S to Kz. */
static void
set_place(double c[RAD_CALC_NCHANNELS], const struct rad_xform *back)
{
    c[11] = back->scale;
    rad_copy(c + 12, back->t);
    for (int i = 0; i < 3; i++)
        rad_scale(c + AXES + 3 * i, 1 / back->scale, back->m[i]);
}

/* Set channels $1 to $27, in calcinit.c's order.  Those that take time are set
 * only if some expression reads them. */
static void
set_channels(double c[RAD_CALC_NCHANNELS], const struct rad_expr *e,
             const struct rad_ray *r)
{
    const struct rad_xform *b = &e->back;
    struct rad_xform move, here;

    if (rad_geom_place(&r->hit, &move)) {
        rad_xform_invert(&here, &move);
        rad_xform_then(&here, &here, b);
        b = &here;
    }
    set_place(c, b);
    if (e->channels & RAYS_WAY)
        turn_inward(c, r->dir, c);
    if (e->channels & NORMAL)
        turn_inward(c, r->n, c + 3);
    if (e->channels & POINT)
        rad_xform_point(c + 6, b, r->hit.p);
    if (e->channels & WAY)
        c[9] = way(r, RAD_RAY_PRIMARY) * b->scale;
    c[10] = rad_least(rad_most(r->cos_o, -1), 1);
    if (e->channels & SHADOW_WAY)
        c[24] = (length(r) + way(r->parent, RAD_RAY_SHADOW)) * b->scale;
    c[25] = r->hit.uv[0];
    c[26] = r->hit.uv[1];
}

void
rad_expr_begin(struct rad_ctx *ctx, const struct rad_expr *e,
               const struct rad_ray *r, struct rad_expr_scope *scope)
{
    scope->in = (struct rad_calc_input){ .channel = scope->channel,
                                         .args = e->args,
                                         .nargs = e->nargs };
    set_channels(scope->channel, e, r);
    rad_calc_begin(ctx->calc, &scope->in);
}

/* If no other ray was begun in between, variables keep their values. */
void
rad_expr_resume(struct rad_ctx *ctx, const struct rad_expr_scope *scope)
{
    if (!rad_calc_is_begun(ctx->calc, &scope->in))
        rad_calc_begin(ctx->calc, &scope->in);
}

void
rad_expr_set_normal(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                    const double norm[3], double cos_n)
{
    rad_expr_inward(scope, norm, scope->channel + RAD_CALC_NORMAL);
    scope->channel[RAD_CALC_NORMAL + 3] = cos_n;
    rad_calc_begin(ctx->calc, &scope->in);
}

void
rad_expr_set_color(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                   struct rad_rgb color)
{
    scope->channel[RAD_CALC_COLOR] = color.r;
    scope->channel[RAD_CALC_COLOR + 1] = color.g;
    scope->channel[RAD_CALC_COLOR + 2] = color.b;
    rad_calc_begin(ctx->calc, &scope->in);
}

void
rad_expr_set_aim(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                 const double dir[3])
{
    static const double none[3];

    rad_expr_inward(scope, dir ? dir : none, scope->channel + RAD_CALC_AIM);
    rad_calc_begin(ctx->calc, &scope->in);
}

bool
rad_expr_sound(struct rad_ctx *ctx, const struct rad_expr *e,
               enum rad_calc_fault fault)
{
    if (fault == RAD_CALC_SOUND)
        return true;
    rad_counts_fault(&ctx->counts, e->object);
    return false;
}

/* A value that is infinite without a fault is one that nothing drops. */
static void
note_infinite(double v, enum rad_calc_fault *fault)
{
    if (!isfinite(v))
        *fault = RAD_CALC_NO_ARG;
}

/* The value of expression i, evaluated after others with *fault. */
static double
evaluate(struct rad_ctx *ctx, const struct rad_expr *e, int i,
         enum rad_calc_fault *fault)
{
    double v;

    if (e->numbers >> i & 1)
        return e->number[i];
    rad_calc_go_on(ctx->calc, *fault);
    v = rad_calc_eval(ctx->job->calc, e->code[i], ctx->calc, fault);
    note_infinite(v, fault);
    return isfinite(v) ? v : 0;
}

bool
rad_expr_get(struct rad_ctx *ctx, const struct rad_expr *e, int first, int n,
             double value[])
{
    enum rad_calc_fault fault = RAD_CALC_SOUND;

    for (int i = 0; i < n && fault == RAD_CALC_SOUND; i++)
        value[i] = evaluate(ctx, e, first + i, &fault);
    return rad_expr_sound(ctx, e, fault);
}

bool
rad_expr_get_all(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                 int n, bool backward, double value[])
{
    enum rad_calc_fault fault = RAD_CALC_SOUND;

    for (int i = 0; i < n; i++)
        value[i] = 0;
    for (int k = 0; k < n && fault <= RAD_CALC_MATH; k++) {
        int i = backward ? n - 1 - k : k;

        value[i] = evaluate(ctx, e, first + i, &fault);
    }
    return rad_expr_sound(ctx, e, fault);
}

/* Begin for a ray, unless these expressions are all plain numbers. */
static void
begin_for(struct rad_ctx *ctx, const struct rad_expr *e,
          const struct rad_ray *r, int first, int n,
          struct rad_expr_scope *scope)
{
    unsigned all = ((1u << n) - 1) << first;

    if ((e->numbers & all) != all)
        rad_expr_begin(ctx, e, r, scope);
}

bool
rad_expr_values(struct rad_ctx *ctx, const struct rad_expr *e,
                const struct rad_ray *r, int first, int n, double value[])
{
    struct rad_expr_scope scope;

    begin_for(ctx, e, r, first, n, &scope);
    return rad_expr_get(ctx, e, first, n, value);
}

bool
rad_expr_values_all(struct rad_ctx *ctx, const struct rad_expr *e,
                    const struct rad_ray *r, int n, bool backward,
                    double value[])
{
    struct rad_expr_scope scope;

    begin_for(ctx, e, r, 0, n, &scope);
    return rad_expr_get_all(ctx, e, 0, n, backward, value);
}

bool
rad_expr_call_next(struct rad_ctx *ctx, int function, const double arg[],
                   enum rad_calc_fault *fault, double *value)
{
    rad_calc_go_on(ctx->calc, *fault);
    *value = rad_calc_call(ctx->job->calc, function, arg, ctx->calc, fault);
    note_infinite(*value, fault);
    return *fault <= RAD_CALC_MATH;
}

bool
rad_expr_call(struct rad_ctx *ctx, const struct rad_expr *e, int function,
              const double arg[], double *value)
{
    enum rad_calc_fault fault = RAD_CALC_SOUND;

    rad_expr_call_next(ctx, function, arg, &fault, value);
    return rad_expr_sound(ctx, e, fault);
}

void
rad_expr_outward(const struct rad_expr *e, const struct rad_ray *r, double v[3])
{
    struct rad_xform move;
    double w[3];

    rad_xform_vector(w, &e->move, v);
    rad_scale(v, 1 / e->move.scale, w);
    if (rad_geom_place(&r->hit, &move)) {
        rad_xform_vector(w, &move, v);
        rad_scale(v, 1 / move.scale, w);
    }
}

double
rad_expr_scale(const struct rad_expr *e, const struct rad_ray *r)
{
    struct rad_xform move;

    if (rad_geom_place(&r->hit, &move))
        return e->move.scale * move.scale;
    return e->move.scale;
}
