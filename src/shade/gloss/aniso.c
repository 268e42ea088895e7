/* aniso.c - see aniso.h */
#include "config.h"

#include "shade/gloss/aniso.h"
#include "base/vec.h"
#include "light/direct/source.h"
#include "shade/gloss/gloss.h"

#include <float.h>

struct aniso {
    enum rad_otype type;
    struct rad_rgb color;
    double spec, au, av, trans, tspec; /* the arguments */
    struct rad_expr expr;              /* of vector u */
};

/* A hit on such a surface. */
struct aniso_hit {
    const struct aniso *m;
    struct rad_gloss gloss;
    struct rad_gloss_parts parts;
    double cos_n;    /* -dir.norm, at least .001 */
    double ahead[3]; /* direction of tspec's lobe */
    bool flat;       /* flat, and without texture */
};

int
rad_aniso_prepare(struct rad_job *job, int32_t index,
                  const struct rad_files *files, const void **data,
                  struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int n = o->type == RAD_TRANS2 ? 8 : 6;
    int code;
    struct aniso *m =
        rad_material_begin(job, index, n, n, sizeof *m, &code, err);

    if (!m)
        return code;
    m->type = o->type;
    m->color = rad_job_colour(job, o->reals);
    m->spec = o->reals[3];
    m->au = o->reals[4];
    m->av = o->reals[5];
    m->trans = n == 8 ? o->reals[6] : 0;
    m->tspec = n == 8 ? o->reals[7] : 0;
    *data = m;
    return rad_expr_prepare(job, o, files, 07, &m->expr, err);
}

/* rad_brdf_fn */
static void
brdf(struct rad_rgb *coef, void *data, const double ldir[3], double omega)
{
    const struct aniso_hit *hit = data;
    const struct rad_gloss *g = &hit->gloss;
    const struct rad_gloss_parts *p = &hit->parts;
    double cos_l = rad_dot(g->norm, ldir), part, lobe;

    *coef = rad_grey(0);
    if (fabs(cos_l) <= RAD_TINY)
        return;
    part = cos_l > 0 ? p->rdiff : p->tdiff;
    if (part > RAD_TINY)
        *coef = rad_rgb_scale(p->color, part * fabs(cos_l) * omega / M_PI);
    if (cos_l > 0 && p->rspec > RAD_TINY) {
        /* the light's extent, since -dj 0 aims all samples at its centre */
        double spread = (1 - g->ctx->job->params.srcjitter) * omega;

        lobe = rad_gloss_brdf(g, ldir, hit->flat ? spread / (4 * M_PI) : 0);
        if (lobe > RAD_TINY)
            *coef = rad_rgb_add(
                *coef, rad_rgb_scale(p->spec_color, lobe * cos_l * omega));
    } else if (cos_l < 0 && p->tspec > RAD_TINY) {
        lobe = rad_gloss_btdf(g, hit->ahead, hit->cos_n, ldir, omega);
        if (lobe > RAD_TINY)
            *coef = rad_rgb_add(
                *coef, rad_rgb_scale(p->color, lobe * p->tspec * omega));
    }
}

bool
rad_aniso_frame(double u[3], double v[3], const double norm[3],
                const double along[3])
{
    double len2 = rad_dot(along, along);

    rad_cross(v, norm, along);
    /* a parallel vector leaves rounding errors only */
    if (!(rad_dot(v, v) > 64 * DBL_EPSILON * DBL_EPSILON * len2) ||
        rad_normalize(v) == 0) {
        rad_frame(u, v, norm);
        return false;
    }
    rad_cross(u, v, norm);
    return true;
}

/* Turn the expressions' values to the world, or set zero if they are
 * unsound. */
static void
take_along(double along[3], const struct rad_expr *e, const struct rad_ray *r,
           bool sound)
{
    if (sound)
        rad_expr_outward(e, r, along);
    else
        along[0] = along[1] = along[2] = 0;
}

void
rad_aniso_along(struct rad_ctx *ctx, const struct rad_expr *e,
                const struct rad_ray *r, double along[3])
{
    take_along(along, e, r, rad_expr_values_all(ctx, e, r, 3, false, along));
}

void
rad_aniso_get(struct rad_ctx *ctx, const struct rad_expr *e, int first,
              const struct rad_ray *r, double along[3])
{
    take_along(along, e, r, rad_expr_get_all(ctx, e, first, 3, false, along));
}

/* Set the roughness along u and v.  Without a direction u it is the same in all
 * directions. */
static void
orient(struct aniso_hit *hit)
{
    struct rad_gloss *g = &hit->gloss;
    const struct aniso *m = hit->m;
    double along[3];

    rad_aniso_along(g->ctx, &m->expr, g->r, along);
    g->au = m->au;
    g->av = m->av;
    if (!rad_aniso_frame(g->u, g->v, g->norm, along))
        g->au = g->av = sqrt((m->au * m->au + m->av * m->av) / 2);
}

/* Split the light into its parts. */
static void
divide(struct aniso_hit *hit)
{
    double thresh = hit->gloss.ctx->job->params.specthresh + RAD_TINY;
    struct rad_gloss_parts *p = &hit->parts;
    const struct aniso *m = hit->m;

    p->rspec = m->spec;
    p->trans = m->trans * (1 - m->spec);
    p->tspec = p->trans * m->tspec;
    p->tdiff = p->trans - p->tspec;
    p->rdiff = 1 - p->trans - m->spec;
    p->follow_refl = p->rspec > thresh;
    p->follow_tran = p->tspec > thresh;
    p->color = rad_rgb_mul(m->color, hit->gloss.r->pattern);
    p->spec_color = m->type == RAD_METAL2 ? rad_rgb_scale(p->color, m->spec)
                                          : rad_grey((float)m->spec);
}

static void
enter(struct aniso_hit *hit, struct rad_ctx *ctx, const struct aniso *m,
      struct rad_ray *r)
{
    struct rad_gloss *g = &hit->gloss;

    hit->m = m;
    g->ctx = ctx;
    g->r = r;
    hit->flat = !rad_ray_perturbed(r) && rad_ray_on_flat(ctx, r);
    hit->cos_n = rad_ray_normal(r, g->norm);
    hit->cos_n = rad_most(hit->cos_n, .001); /* brdf() divides by it */
    rad_ray_ahead(ctx, r, hit->ahead);
    divide(hit);
    orient(hit);
}

bool
rad_aniso_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                struct rad_ray *r)
{
    struct aniso_hit hit;

    if (r->path & RAD_RAY_SHADOW)
        return true;
    if (!rad_ray_face(ctx, r, mat->next))
        return true;
    enter(&hit, ctx, mat->data, r);
    rad_gloss_follow(&hit.gloss, hit.ahead, &hit.parts);
    rad_gloss_ambient(ctx, r, hit.gloss.norm, &hit.parts);
    rad_direct(ctx, r, brdf, &hit, hit.parts.trans > RAD_TINY);
    return true;
}
