/* ashik.c - see ashik.h */
#include "config.h"

#include "shade/gloss/ashik.h"
#include "arith/elementary.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/indirect/ambient.h"
#include "light/direct/source.h"
#include "shade/gloss/aniso.h"
#include "shade/gloss/gloss.h"

struct ashik {
    struct rad_rgb color, spec_color;
    double nu, nv;        /* powers along u and v */
    struct rad_expr expr; /* of vector u */
};

/* A hit on such a surface. */
struct ashik_hit {
    struct rad_ctx *ctx;
    struct rad_ray *r;
    struct rad_rgb color;       /* with the patterns */
    struct rad_rgb spec_color;  /* at the eye's angle */
    double norm[3], u[3], v[3]; /* orthonormal, norm tilted by textures */
    double nu, nv;
    double cos_n; /* -dir.norm, at least .001 */
    /* there is gloss; it is strong enough to be sampled (-st) */
    bool glossy, follow;
};

int
rad_ashik_prepare(struct rad_job *job, int32_t index,
                  const struct rad_files *files, const void **data,
                  struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int code;
    struct ashik *m =
        rad_material_begin(job, index, 8, 8, sizeof *m, &code, err);

    if (!m)
        return code;
    m->color = rad_job_colour(job, o->reals);
    m->spec_color = rad_job_colour(job, o->reals + 3);
    m->nu = o->reals[6];
    m->nv = o->reals[7];
    *data = m;
    return rad_expr_prepare(job, o, files, 07, &m->expr, err);
}

/* Schlick's approximation of Fresnel's formula: at this angle reflectance R
 * rises to R + (1 - R) times this. */
static double
schlick(double cosine)
{
    double s = 1 - cosine;

    return s * s * s * s * s;
}

/* The power of a lobe whose square roughness, about 2 / power, is larger by
 * `wider`. */
static double
widened(double power, double wider)
{
    return power / (1 + .5 * wider * power);
}

/* What a lobe of square roughness a2 loses by dividing by the larger cosine,
 * but for a part that is the same at all angles; tan2: of the eye.  With d the
 * light's tilt from the peak and t the tangent, the loss is the mean of
 * t d + |d|^2 / 2 where that is positive: a2 at the normal, and far from there
 * the roughness times t / sqrt(pi). */
static double
division_loss(double a2, double tan2)
{
    return sqrt(a2 * a2 + a2 * tan2 / M_PI);
}

/* As rad_gloss_reflect_gain(), for a lobe that loses more than Ward's by
 * division_loss(). */
static double
reflect_gain(const struct ashik_hit *hit, double cos2, double wider)
{
    double u = rad_dot(hit->r->dir, hit->u), v = rad_dot(hit->r->dir, hit->v);
    double gain = rad_gloss_reflect_gain(hit->r, cos2), a2, tan2;

    if (!(wider > 0))
        return gain;
    if (!(u * u + v * v > 0))
        return gain + wider;
    a2 = 2 * (u * u + v * v) / (hit->nu * u * u + hit->nv * v * v);
    tan2 = (1 - cos2) / cos2;
    return gain + division_loss(a2 + wider, tan2) - division_loss(a2, tan2);
}

/* The lobe for a light at ldir.  The exponent of cos(theta_h) depends on the
 * direction in which h leans; at the normal any exponent gives 1. */
static double
lobe(const struct ashik_hit *hit, const double ldir[3], double cos_l)
{
    double h[3], hu, hv, hn, lean, power, cos2, wider, nu, nv;

    rad_sub(h, ldir, hit->r->dir);
    if (rad_normalize(h) == 0)
        return 0;
    hu = rad_dot(h, hit->u);
    hv = rad_dot(h, hit->v);
    hn = rad_dot(h, hit->norm);
    if (!(hn > 0))
        return 0;
    lean = hu * hu + hv * hv;
    cos2 = rad_dot(ldir, h);
    cos2 = rad_least(cos2 * cos2, 1);
    wider = rad_gloss_widening(hit->r, cos2);
    nu = widened(hit->nu, wider);
    nv = widened(hit->nv, wider);
    power = lean > 0 ? (nu * hu * hu + nv * hv * hv) / lean : 0;
    return reflect_gain(hit, cos2, wider) * sqrt((nu + 1) * (nv + 1)) *
           rad_pow(hn, power) /
           (8 * M_PI * rad_dot(ldir, h) * rad_most(cos_l, hit->cos_n));
}

/* rad_brdf_fn */
static void
brdf(struct rad_rgb *coef, void *data, const double ldir[3], double omega)
{
    const struct ashik_hit *hit = data;
    double cos_l = rad_dot(hit->norm, ldir), f;

    *coef = rad_grey(0);
    if (cos_l <= RAD_TINY)
        return;
    f = (1 - schlick(cos_l)) / M_PI;
    *coef = rad_rgb_scale(hit->color, f * cos_l * omega);
    if (!hit->glossy)
        return;
    f = lobe(hit, ldir, cos_l);
    if (f > RAD_TINY)
        *coef = rad_rgb_add(*coef,
                            rad_rgb_scale(hit->spec_color, f * cos_l * omega));
}

/* Set u, v and the powers along them.  Without a direction u the power is the
 * same in all directions: the harmonic mean, as in Radiance, which adds 1e-5 so
 * that powers of 0 have a mean. */
static void
orient(struct ashik_hit *hit, const struct ashik *m)
{
    double along[3];

    rad_aniso_along(hit->ctx, &m->expr, hit->r, along);
    hit->nu = m->nu;
    hit->nv = m->nv;
    if (!rad_aniso_frame(hit->u, hit->v, hit->norm, along))
        hit->nu = hit->nv = 2 / (1 / (m->nu + 1e-5) + 1 / (m->nv + 1e-5));
}

static void
enter(struct ashik_hit *hit, struct rad_ctx *ctx, const struct ashik *m,
      struct rad_ray *r)
{
    double thresh = ctx->job->params.specthresh + RAD_TINY;
    float rise;

    hit->ctx = ctx;
    hit->r = r;
    hit->color = rad_rgb_mul(m->color, r->pattern);
    hit->cos_n = rad_most(rad_ray_normal(r, hit->norm), .001);
    hit->glossy = rad_rgb_max(m->spec_color) > RAD_TINY;
    hit->follow = hit->glossy && rad_rgb_lum(m->spec_color) > thresh;
    rise = (float)schlick(hit->cos_n);
    hit->spec_color =
        rad_rgb_add(rad_rgb_scale(m->spec_color, 1 - rise), rad_grey(rise));
    orient(hit, m);
}

/* Draw a direction of reflection from the model's density of half vectors;
 * false: it does not leave the surface. */
static bool
draw_reflection(const struct ashik_hit *hit, int i, int trial, double dir[3])
{
    const struct rad_ray *r = hit->r;
    double x[2], a, b, len, cosine, sine, h[3];

    rad_gloss_square(r, RAD_DIM_RSPECULAR, i, trial, x);
    rad_sin_and_cos(2 * M_PI * x[0], &b, &a);
    a *= sqrt(hit->nv + 1);
    b *= sqrt(hit->nu + 1);
    len = sqrt(a * a + b * b);
    a /= len;
    b /= len;
    cosine = rad_pow(1 - x[1], 1 / (hit->nu * a * a + hit->nv * b * b + 1));
    sine = sqrt(rad_most(1 - cosine * cosine, 0));
    rad_scale(h, cosine, hit->norm);
    rad_madd(h, h, a * sine, hit->u);
    rad_madd(h, h, b * sine, hit->v);
    rad_madd(dir, r->dir, -2 * rad_dot(h, r->dir), h);
    return rad_normalize(dir) > 0 && rad_dot(dir, r->n) > RAD_TINY;
}

/* Add gloss by samples.  Each has weight 1; a sample below the surface is drawn
 * again. */
static void
reflect_gloss(const struct ashik_hit *hit)
{
    struct rad_ray *r = hit->r, sr;
    struct rad_rgb sum = rad_grey(0);
    int n;

    if (!rad_ray_spawn(hit->ctx, &sr, RAD_RAY_RSPECULAR, r, &hit->spec_color,
                       RAD_BRANCH_RSPECULAR))
        return;
    n = rad_gloss_count(hit->ctx, r, &sr);
    sr.weight /= (float)n;
    for (int i = 0; i < n; i++) {
        int trial = 0;

        while (!draw_reflection(hit, i, trial, sr.dir) &&
               ++trial < RAD_GLOSS_TRIALS)
            ;
        if (trial == RAD_GLOSS_TRIALS)
            continue;
        sr.key = rad_key_branch(r->key, RAD_BRANCH_RSPECULAR | (uint32_t)i);
        rad_ray_trace(hit->ctx, &sr);
        sum = rad_rgb_add(sum, sr.L);
    }
    sum = rad_rgb_scale(rad_rgb_mul(sum, sr.coef), 1. / n);
    r->L = rad_rgb_add(r->L, sum);
}

bool
rad_ashik_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                struct rad_ray *r)
{
    struct ashik_hit hit;
    struct rad_rgb coef;

    if (r->path & RAD_RAY_SHADOW)
        return true;
    if (!rad_ray_face(ctx, r, mat->next))
        return true;
    enter(&hit, ctx, mat->data, r);
    if (hit.follow)
        reflect_gloss(&hit);
    if (rad_rgb_max(hit.color) > RAD_TINY) {
        coef = hit.color;
        if (hit.glossy && !hit.follow)
            coef = rad_rgb_add(coef, hit.spec_color);
        rad_ambient_apply(ctx, r, hit.norm, &coef);
        r->L = rad_rgb_add(r->L, coef);
    }
    rad_direct(ctx, r, brdf, &hit, false);
    return true;
}
