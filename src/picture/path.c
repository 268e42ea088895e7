/* path.c - see path.h */
#include "config.h"

#include "picture/path.h"

#include "arith/elementary.h"
#include "base/rng.h"
#include "base/vec.h"
#include "trace/material.h"

#include <math.h>
#include <stdatomic.h>

/* The most panes that a path passes at its start. */
#define MOST_PANES 8

/* The reflectance that a path assumes of all surfaces, as passes do that make
 * records before rays ask for them. */
#define MEAN_REFLECTANCE .5f

/* Does light pass straight through the surface that was hit? */
static bool
is_pane(const struct rad_job *job, const struct rad_hit *hit)
{
    int32_t mod = job->scene->objects[hit->obj].modifier;
    int32_t mat = rad_material_of(job->scene, mod);

    return mat == RAD_VOID || job->materials[mat].flags & RAD_MAT_TRANSPARENT;
}

bool
rad_path_meet(struct rad_ctx *ctx, struct rad_ray *r)
{
    struct rad_span span = { .tmin = 0, .tmax = r->tmax };

    if (r->parent)
        rad_geom_leave(&r->parent->hit, r->dir, r->org);
    rad_ray_clear(r);
    rad_copy(span.org, r->org);
    rad_copy(span.dir, r->dir);
    ctx->counts.rays++;
    if (!rad_geom_nearest(ctx->job->geom, &span, &r->hit, &ctx->counts.geom))
        return false;
    rad_ray_enter(r);
    return true;
}

static double
fraction(double x)
{
    return x - floor(x);
}

bool
rad_path_begin(const struct rad_frame *f, struct rad_ctx *ctx, uint64_t spread,
               uint64_t n, uint64_t key, struct rad_ray *r)
{
    double u = fraction(rad_rand(spread, 0) + (double)n * .7548776662466927);
    double v = fraction(rad_rand(spread, 1) + (double)n * .5698402909980532);
    int x = (int)(u * f->width), y = (int)(v * f->height);
    bool met;

    /* for the watcher of stuck threads: a pattern may never end here, too */
    atomic_store_explicit(&ctx->at, RAD_AT(x, y), memory_order_relaxed);
    if (!rad_frame_start(f, ctx, x, y, r, &met))
        return false;
    r->key = key;
    if (met)
        return true;
    for (int panes = 0; rad_path_meet(ctx, r); panes++) {
        if (panes == MOST_PANES || !is_pane(ctx->job, &r->hit))
            return true;
        r->tmax -= r->hit.t;
        rad_geom_leave(&r->hit, r->dir, r->org);
    }
    return false;
}

bool
rad_path_bounce(struct rad_ctx *ctx, const struct rad_ray *parent, uint64_t key,
                int k, struct rad_ray *r)
{
    const struct rad_rgb coef = rad_grey(MEAN_REFLECTANCE);
    double u = rad_rand(key, 2 * (uint32_t)k);
    double a[3], b[3], w[3], sine, cosine;

    if (!rad_ray_spawn(ctx, r, RAD_RAY_RAMBIENT, parent, &coef,
                       RAD_PATH_BRANCH))
        return false;
    ctx->counts.ambient_rays++;
    rad_scale(w, parent->cos_o < 0 ? -1 : 1, parent->n);
    rad_frame(a, b, w);
    rad_sin_and_cos(2 * M_PI * rad_rand(key, 2 * (uint32_t)k + 1), &sine,
                    &cosine);
    rad_scale(r->dir, sqrt(1 - u), w);
    rad_madd(r->dir, r->dir, sqrt(u) * cosine, a);
    rad_madd(r->dir, r->dir, sqrt(u) * sine, b);
    return true;
}

void
rad_path_place(const struct rad_ray *r, int level, struct rad_ambplace *at)
{
    at->level = level;
    at->weight = (double)r->weight;
    at->err = r->hit.err;
    rad_copy(at->p, r->hit.p);
    rad_scale(at->n, r->cos_o < 0 ? -1 : 1, r->n);
    rad_copy(at->pn, at->n);
}
