/* func.c - see func.h */
#include "config.h"

#include "pattern/func.h"
#include "pattern/effect.h"
#include "pattern/mixture.h"

/* The expressions, as bits: all strings before the function file, but for the
 * two that a mixture mixes. */
static unsigned
expressions(enum rad_otype type)
{
    unsigned before = (1u << rad_otype_files(type).function) - 1;

    return type == RAD_MIXFUNC ? before & ~3u : before;
}

static bool
values(struct rad_ctx *ctx, const struct rad_effect *e, const struct rad_ray *r,
       double value[3])
{
    return rad_expr_values(ctx, &e->expr, r, 0, e->expr.n, value);
}

/* A colour: rpict as it is usually built evaluates it from blue to red. */
static bool
colors(struct rad_ctx *ctx, const struct rad_effect *e, const struct rad_ray *r,
       double value[3])
{
    return rad_expr_values_all(ctx, &e->expr, r, 3, true, value);
}

int
rad_func_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    struct rad_effect *e = rad_arena_calloc(&job->arena, 1, sizeof *e);
    int rc;

    if (!e)
        return rad_fail_memory(err);
    e->values = o->type == RAD_COLORFUNC ? colors : values;
    rc = rad_expr_prepare(job, o, files, expressions(o->type), &e->expr, err);
    if (rc == 0 && o->type == RAD_MIXFUNC)
        rc = rad_mixture_parts(job, index, e->part, err);
    if (o->type == RAD_COLORFUNC)
        rad_effect_channels(job, e);
    *data = e;
    return rc;
}
