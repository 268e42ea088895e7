/* dielectric.c - see dielectric.h
 *
 * The surface parts two media: the inner one, from which its normal points
 * away, and the outer one.  The extinction along a ray that arrives from within
 * is known only at this hit, which shows what medium the ray went through: it
 * is set in r->ext, and applied when the ray is finished. */
#include "config.h"

#include "shade/dielectric.h"
#include "arith/elementary.h"
#include "base/vec.h"
#include "shade/mist.h"

#define HARTMANN_NM 500.0 /* wavelength for which the index is computed */

struct dielectric {
    double n_ratio;                 /* index inside / index outside */
    double in[3], out[3];           /* transmission per unit length */
    struct rad_rgb in_ext, out_ext; /* the same as extinction [1/unit] */
    bool interface;                 /* type interface: a solid outside, too */
};

/* A hit on a dielectric. */
struct boundary {
    double norm[3], cos_i; /* perturbed normal on the ray's side */
    double eta;            /* index on the ray's side / beyond */
    double cos_r;          /* cosine of refraction; 0: total reflection */
    double side;           /* 1: the ray is outside, -1: inside */
    bool textured;         /* a texture tilts the normal */
    bool unmirrored;       /* flat: an image looks as far as its path is long */
    struct rad_rgb beyond; /* extinction beyond the surface */
    const struct rad_medium *medium; /* medium beyond: mist.h */
    struct rad_medium link;          /* storage for it */
};

/* Extinction for a transmission per unit length.  For a transmission of 0 or
 * less it is 100: exp(-100) times any float is as good as 0. */
static float
extinction(double transmission)
{
    if (transmission < 1e-40)
        return 100;
    return transmission >= 1 ? 0 : (float)-rad_log(transmission);
}

static struct rad_rgb
extinction_rgb(const double t[3], struct rad_rgb pattern)
{
    return rad_rgb(extinction(t[0] * pattern.r), extinction(t[1] * pattern.g),
                   extinction(t[2] * pattern.b));
}

int
rad_dielectric_prepare(struct rad_job *job, int32_t index,
                       const struct rad_files *files, const void **data,
                       struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    bool interface = o->type == RAD_INTERFACE;
    int n = interface ? 8 : 5;
    int code;
    struct dielectric *m =
        rad_material_begin(job, index, n, n, sizeof *m, &code, err);

    (void)files;
    if (!m)
        return code;
    for (int i = 0; i < 3; i++) {
        m->in[i] = o->reals[job->primary[i]];
        m->out[i] = interface ? o->reals[4 + job->primary[i]] : 0;
    }
    m->in_ext = extinction_rgb(m->in, rad_grey(1));
    m->interface = interface;
    if (interface) {
        m->n_ratio = o->reals[3] / o->reals[7];
        m->out_ext = extinction_rgb(m->out, rad_grey(1));
    } else {
        m->n_ratio = o->reals[3] + o->reals[4] / HARTMANN_NM;
        m->out_ext = job->params.cextinction;
    }
    if (!(m->n_ratio > 0 && m->n_ratio < INFINITY))
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "refractive index must be positive");
    *data = m;
    return 0;
}

static bool
is_white(struct rad_rgb c)
{
    return c.r == 1 && c.g == 1 && c.b == 1;
}

/* Set b->medium, the medium beyond, and correct r->medium.  Beyond a
 * dielectric, for a ray from within, is the medium in which the dielectric was
 * entered; an interface lies between two solids. */
static void
cross_mists(const struct rad_job *job, const struct dielectric *m,
            struct rad_ray *r, struct boundary *b, bool inside)
{
    const struct rad_medium *here = r->medium;

    if ((inside || m->interface) && here && !here->solid)
        r->medium = NULL; /* the ray started inside the solid, without a link */
    if (m->interface)
        b->medium = r->medium;
    else if (!inside)
        b->medium = rad_medium_solid(&b->link, here);
    else if ((b->medium = rad_medium_about(job, here)) && !b->medium->solid)
        b->beyond = b->medium->ext;
}

/* Set the extinction and medium of the ray, and those beyond the surface. */
static void
cross_media(const struct rad_job *job, const struct dielectric *m,
            struct rad_ray *r, struct boundary *b)
{
    struct rad_rgb in = m->in_ext, out = m->out_ext;
    bool inside = b->side < 0;

    if (!is_white(r->pattern)) {
        in = extinction_rgb(m->in, r->pattern);
        if (m->interface)
            out = extinction_rgb(m->out, r->pattern);
    }
    if (inside)
        r->ext = in;
    else if (m->interface)
        r->ext = out;
    b->beyond = inside ? out : in;
    cross_mists(job, m, r, b, inside);
}

static void
enter(struct rad_ctx *ctx, const struct dielectric *m, struct rad_ray *r,
      struct boundary *b)
{
    double cos2_r;

    b->textured = rad_ray_perturbed(r);
    b->unmirrored =
        rad_ray_on_flat(ctx, r) && (!b->textured || r->path & RAD_RAY_AMBIENT);
    b->cos_i = rad_ray_normal(r, b->norm);
    b->side = b->cos_i < 0 ? -1 : 1;
    b->cos_i *= b->side;
    rad_scale(b->norm, b->side, b->norm);
    b->eta = b->side < 0 ? m->n_ratio : 1 / m->n_ratio;
    cos2_r = 1 - b->eta * b->eta * (1 - b->cos_i * b->cos_i); /* Snell */
    b->cos_r = cos2_r < RAD_TINY ? 0 : sqrt(cos2_r);
}

/* Fresnel's reflectance, the mean of both polarizations. */
static double
reflectance(const struct boundary *b)
{
    double rp = (b->cos_i - b->eta * b->cos_r) / (b->cos_i + b->eta * b->cos_r);
    double rs = (b->cos_r - b->eta * b->cos_i) / (b->cos_r + b->eta * b->cos_i);

    return b->cos_r > 0 ? .5 * (rp * rp + rs * rs) : 1;
}

static void
refract(struct rad_ctx *ctx, const struct boundary *b, struct rad_ray *r,
        double share)
{
    /* radiance grows with the square of the index: the same light in a
     * narrower cone */
    struct rad_rgb coef = rad_grey((float)(share * b->eta * b->eta));
    double bend = b->eta * b->cos_i - b->cos_r, along[3];
    struct rad_ray tr;

    if (!rad_ray_spawn(ctx, &tr, RAD_RAY_REFRACTED, r, &coef,
                       RAD_BRANCH_REFRACT))
        return;
    tr.ext = b->beyond;
    tr.medium = b->medium;
    rad_scale(along, b->eta, r->dir);
    rad_madd(tr.dir, along, bend, b->norm);
    if (b->textured && rad_dot(tr.dir, r->n) * b->side >= -RAD_TINY)
        rad_madd(tr.dir, along, bend * b->side, r->n); /* not back out */
    rad_normalize(tr.dir);
    rad_ray_trace(ctx, &tr);
    r->L = rad_rgb_add(r->L, rad_rgb_mul(tr.L, tr.coef));
    if (b->unmirrored || fabs(b->eta - 1) <= RAD_TINY)
        r->dist = r->hit.t + rad_ray_way_of(&tr);
}

static void
reflect(struct rad_ctx *ctx, const struct boundary *b, struct rad_ray *r,
        double share)
{
    struct rad_rgb coef = rad_grey((float)share);
    struct rad_ray lr;

    if (!rad_ray_spawn(ctx, &lr, RAD_RAY_REFLECTED, r, &coef,
                       RAD_BRANCH_REFLECT))
        return;
    rad_madd(lr.dir, r->dir, 2 * b->cos_i, b->norm);
    if (b->textured && rad_dot(lr.dir, r->n) * b->side <= RAD_TINY)
        rad_madd(lr.dir, r->dir, 2 * r->cos_o, r->n); /* not through it */
    rad_ray_mirror(ctx, r, &lr, b->unmirrored);
}

bool
rad_dielectric_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r)
{
    const struct dielectric *m = mat->data;
    struct boundary b;
    double share;

    rad_ray_texture(ctx, r, mat->next);
    enter(ctx, m, r, &b);
    cross_media(ctx->job, m, r, &b);
    share = reflectance(&b);
    if (b.cos_r > 0)
        refract(ctx, &b, r, 1 - share);
    if (!(r->path & RAD_RAY_SHADOW))
        reflect(ctx, &b, r, share);
    return true;
}
