/* glass.c - see glass.h */
#include "config.h"

#include "shade/glass.h"
#include "arith/elementary.h"
#include "base/vec.h"

#define GLASS_INDEX 1.52 /* of window glass, if no index is given */

/* A transmissivity below this is raised to it, so that it has a logarithm. */
#define LEAST_TRANSMISSIVITY 1e-15

struct glass {
    double log_tn[3]; /* logarithm of the transmissivity at normal incidence */
    double index;
    bool clear; /* lets light through in some channel */
};

/* A hit on glass. */
struct pane {
    const struct glass *m;
    double norm[3], cos_n; /* perturbed normal, toward the ray */
    bool textured;
    struct rad_rgb T, R; /* transmittance, reflectance */
};

int
rad_glass_prepare(struct rad_job *job, int32_t index,
                  const struct rad_files *files, const void **data,
                  struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int code;
    struct glass *m =
        rad_material_begin(job, index, 3, 4, sizeof *m, &code, err);

    (void)files;
    if (!m)
        return code;
    for (int i = 0; i < 3; i++) {
        double tn = o->reals[job->primary[i]];

        m->clear |= tn > LEAST_TRANSMISSIVITY;
        m->log_tn[i] = rad_log(fmax(tn, LEAST_TRANSMISSIVITY));
    }
    m->index = o->nreals == 4 ? o->reals[3] : GLASS_INDEX;
    if (!(m->index > 0))
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "refractive index must be positive");
    *data = m;
    return 0;
}

/* Transmittance T and reflectance R of a slab, with surface reflectance r and
 * inner transmittance t, all inner reflections summed:
 *   T = (1-r)^2 t / (1 - r^2 t^2),  R = r (1 + (1-2r) t^2) / (1 - r^2 t^2) */
static void
slab(double r, double t, double *T, double *R)
{
    double q = 1 - r * r * t * t;

    if (q > 0) {
        *T = (1 - r) * (1 - r) * t / q;
        *R = r * (1 + (1 - 2 * r) * t * t) / q;
    } else { /* grazing: both surfaces reflect all light */
        *T = 0;
        *R = 1;
    }
}

/* Set p->T and p->R, the means of both polarizations.  cos_r is the cosine
 * within the glass: light travels 1/cos_r times the glass's thickness. */
static void
pane_fresnel(struct pane *p)
{
    double n = p->m->index, cos_i = p->cos_n, T[3], R[3];
    double cos2_r = 1 - (1 - cos_i * cos_i) / (n * n);
    double cos_r, rs, rp;

    if (!(cos2_r > 0)) { /* an index below 1: total reflection */
        p->T = rad_grey(0);
        p->R = rad_grey(1);
        return;
    }
    cos_r = sqrt(cos2_r);
    rs = (cos_i - n * cos_r) / (cos_i + n * cos_r);
    rp = (cos_r - n * cos_i) / (cos_r + n * cos_i);
    for (int i = 0; i < 3; i++) {
        double t, Ts, Rs, Tp, Rp;

        if (i > 0 && p->m->log_tn[i] == p->m->log_tn[i - 1]) {
            T[i] = T[i - 1];
            R[i] = R[i - 1];
            continue;
        }
        t = p->m->clear ? rad_exp(p->m->log_tn[i] / cos_r) : 0;
        slab(rs * rs, t, &Ts, &Rs);
        slab(rp * rp, t, &Tp, &Rp);
        T[i] = .5 * (Ts + Tp);
        R[i] = .5 * (Rs + Rp);
    }
    p->T = rad_rgb((float)T[0], (float)T[1], (float)T[2]);
    p->R = rad_rgb((float)R[0], (float)R[1], (float)R[2]);
}

bool
rad_glass_plain(const struct rad_job *job, const struct rad_hit *hit,
                const double dir[3], struct rad_rgb *T)
{
    const struct rad_material *mat =
        rad_material_first(job, job->scene->objects[hit->obj].modifier);
    struct pane p;

    if (hit->bent || !mat || mat->shader->shade != rad_glass_shade ||
        rad_material_first(job, mat->next))
        return false;
    p.m = mat->data;
    p.cos_n = fabs(rad_dot(dir, hit->n));
    *T = rad_grey(0);
    if (p.m->clear) {
        pane_fresnel(&p);
        *T = p.T;
    }
    return true;
}

static void
pass(struct rad_ctx *ctx, const struct pane *p, struct rad_ray *r)
{
    struct rad_rgb coef = rad_rgb_mul(p->T, r->pattern);
    bool straight =
        !p->textured || r->path & (RAD_RAY_SHADOW | RAD_RAY_AMBIENT);
    struct rad_ray tr;

    if (!rad_ray_spawn(ctx, &tr, RAD_RAY_TRANS, r, &coef, RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, r->dir);
    /* a tilted surface bends a ray as a thin prism would */
    if (!straight && rad_ray_bends(ctx, r)) {
        rad_madd(tr.dir, r->dir, 2 * (1 - p->m->index), r->pert);
        if (rad_normalize(tr.dir) == 0)
            rad_copy(tr.dir, r->dir);
    }
    rad_ray_onward(&tr);
    rad_ray_trace(ctx, &tr);
    r->L = rad_rgb_add(r->L, rad_rgb_mul(tr.L, tr.coef));
    if (straight)
        r->dist = r->hit.t + rad_ray_way_of(&tr);
}

static void
reflect(struct rad_ctx *ctx, const struct pane *p, struct rad_ray *r)
{
    struct rad_ray lr;

    if (!rad_ray_spawn(ctx, &lr, RAD_RAY_REFLECTED, r, &p->R,
                       RAD_BRANCH_REFLECT))
        return;
    rad_madd(lr.dir, r->dir, 2 * p->cos_n, p->norm);
    rad_ray_mirror(ctx, r, &lr,
                   rad_ray_on_flat(ctx, r) &&
                       (!p->textured || r->path & RAD_RAY_AMBIENT));
}

bool
rad_glass_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                struct rad_ray *r)
{
    struct pane p = { .m = mat->data };

    if (!ctx->job->params.backvis && r->cos_o <= 0) {
        rad_ray_transmit(ctx, r);
        return true;
    }
    if (!p.m->clear && r->path & RAD_RAY_SHADOW)
        return true;
    rad_ray_texture(ctx, r, mat->next);
    if (r->cos_o < 0)
        rad_ray_flip(r);
    p.textured = rad_ray_perturbed(r);
    p.cos_n = rad_ray_normal(r, p.norm);
    pane_fresnel(&p);
    if (p.m->clear)
        pass(ctx, &p, r);
    if (!(r->path & RAD_RAY_SHADOW))
        reflect(ctx, &p, r);
    return true;
}
