/* prism.c - see prism.h */
#include "config.h"

#include "shade/prism.h"
#include "base/vec.h"
#include "light/direct/source.h"
#include "pattern/expr.h"

#include <string.h>

struct prism {
    int ways;
    struct rad_expr expr; /* for each way: coefficient and direction */
};

int
rad_prism_prepare(struct rad_job *job, int32_t index,
                  const struct rad_files *files, const void **data,
                  struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    struct prism *m = rad_arena_calloc(&job->arena, 1, sizeof *m);

    if (!m)
        return rad_fail_memory(err);
    m->ways = o->type == RAD_PRISM2 ? 2 : 1;
    *data = m;
    return rad_expr_prepare(job, o, files, m->ways == 2 ? 0377 : 017, &m->expr,
                            err);
}

int
rad_prism_ways(const struct rad_material *mat)
{
    return ((const struct prism *)mat->data)->ways;
}

/* Evaluate the coefficient and direction of a way; aim is the direction to a
 * relayed source, or NULL.  False: they have no value. */
static bool
find_way(struct rad_ctx *ctx, const struct prism *m, const struct rad_ray *r,
         int way, const double aim[3], double *coef, double dir[3])
{
    struct rad_expr_scope scope;
    double v[4];

    rad_expr_begin(ctx, &m->expr, r, &scope);
    rad_expr_set_aim(ctx, &scope, aim);
    if (!rad_expr_get(ctx, &m->expr, 4 * way, 4, v))
        return false;
    *coef = v[0];
    rad_copy(dir, v + 1);
    rad_expr_outward(&m->expr, r, dir);
    return true;
}

bool
rad_prism_way(struct rad_ctx *ctx, const struct rad_material *mat,
              const struct rad_ray *r, int way, double dir[3])
{
    double coef;

    return find_way(ctx, mat->data, r, way, NULL, &coef, dir) &&
           coef > RAD_TINY;
}

/* The directions, Dx to Dz and DxA to DzA. */
#define DIRECTIONS (UINT64_C(7) | UINT64_C(7) << RAD_CALC_AIM)

/* As find_way() for a shadow ray to an image of source or image `next`.  Most
 * such rays to the sun have the directions of the one before. */
static bool
find_relay(struct rad_ctx *ctx, const struct prism *m, const struct rad_ray *r,
           int way, int32_t next, double *coef, double dir[3])
{
    struct rad_bent *b = &ctx->bent[r->source];
    double aim[3];

    rad_source_toward(ctx->job->sources, next, r->hit.p, aim);
    if (m->expr.channels & ~DIRECTIONS ||
        memcmp(b->dir, r->dir, sizeof b->dir) != 0 ||
        memcmp(b->aim, aim, sizeof aim) != 0) {
        if (!find_way(ctx, m, r, way, aim, &b->coef, b->out))
            return false;
        rad_copy(b->dir, r->dir);
        rad_copy(b->aim, aim);
    }
    *coef = b->coef;
    rad_copy(dir, b->out);
    return true;
}

/* Send r on by a way; if `next` >= 0, as a shadow ray to that source or image,
 * which the prism relays. */
static void
send(struct rad_ctx *ctx, const struct prism *m, struct rad_ray *r, int way,
     int32_t next)
{
    double coef, dir[3];
    struct rad_rgb grey;
    struct rad_ray tr;
    bool found = next < 0 ? find_way(ctx, m, r, way, NULL, &coef, dir)
                          : find_relay(ctx, m, r, way, next, &coef, dir);

    if (!found || rad_normalize(dir) == 0)
        return;
    grey = rad_grey((float)coef);
    if (!rad_ray_spawn(ctx, &tr, RAD_RAY_TRANS, r, &grey,
                       RAD_BRANCH_TRANSMIT | (uint32_t)way))
        return;
    rad_copy(tr.dir, dir);
    if (next >= 0) {
        tr.source = next;
        rad_source_aimed(ctx, &tr);
    } else {
        rad_ray_trace(ctx, &tr);
    }
    r->L = rad_rgb_add(r->L, rad_rgb_mul(tr.L, tr.coef));
    if (rad_ray_on_flat(ctx, r))
        r->dist = r->hit.t + rad_ray_way_of(&tr);
}

bool
rad_prism_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                struct rad_ray *r)
{
    const struct rad_sources *s = ctx->job->sources;
    const struct prism *m = mat->data;

    if (r->source >= 0) {
        int32_t next = rad_source_shown(s, r->source);

        if (next >= 0 && rad_source_object(s, r->source) == r->hit.obj)
            send(ctx, m, r, rad_source_way(s, r->source), next);
        return true; /* a shadow ray to another target is blocked */
    }
    for (int way = 0; way < m->ways; way++)
        send(ctx, m, r, way, -1);
    return true;
}
