/* mirror.c - see mirror.h
 *
 * A shadow ray that is aimed at an image of a source is relayed: the mirror
 * sends it on toward the source, or other image, that it shows.  No other ray
 * may count that light again.  So if the mirror has an alternate material,
 * indirect rays that meet its front see that material only if it is
 * transparent, as in Radiance. */
#include "config.h"

#include "shade/mirror.h"
#include "base/vec.h"
#include "light/direct/source.h"

struct mirror {
    struct rad_rgb color;
    bool replaced;     /* a string argument names an alternate */
    int32_t alternate; /* this modifier, RAD_VOID: the name is "void" */
    bool see_through;  /* the alternate is transparent, or void */
};

static int
prepare_alternate(const struct rad_job *job, int32_t index, struct mirror *m,
                  struct rad_error *err)
{
    int32_t mat;
    int rc;

    m->alternate = RAD_VOID;
    m->replaced = job->scene->objects[index].nstrings > 0;
    if (!m->replaced)
        return 0;
    rc = rad_scene_named(job->scene, index, 0, &m->alternate, err);
    mat = rad_material_of(job->scene, m->alternate);
    m->see_through =
        mat == RAD_VOID || job->materials[mat].flags & RAD_MAT_TRANSPARENT;
    return rc;
}

int
rad_mirror_prepare(struct rad_job *job, int32_t index,
                   const struct rad_files *files, const void **data,
                   struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int code;
    struct mirror *m =
        rad_material_begin(job, index, 3, 3, sizeof *m, &code, err);

    (void)files;
    if (!m)
        return code;
    m->color = rad_job_colour(job, o->reals);
    *data = m;
    return prepare_alternate(job, index, m, err);
}

bool
rad_mirror_plain(const struct rad_job *job, int32_t obj, struct rad_rgb *color)
{
    const struct rad_material *mat =
        rad_material_first(job, job->scene->objects[obj].modifier);
    const struct mirror *m;

    if (!mat || mat->shader->shade != rad_mirror_shade ||
        rad_material_first(job, mat->next))
        return false;
    m = mat->data;
    *color = m->color;
    return true;
}

static void
reflect(double dir[3], const struct rad_ray *r, double cosine,
        const double norm[3])
{
    rad_madd(dir, r->dir, 2 * cosine, norm);
}

/* Send a shadow ray on to source `next`, which the mirror shows. */
static void
relay(struct rad_ctx *ctx, const struct rad_rgb *coef, struct rad_ray *r,
      int32_t next)
{
    struct rad_ray lr;

    if (!rad_ray_spawn(ctx, &lr, RAD_RAY_REFLECTED, r, coef,
                       RAD_BRANCH_REFLECT))
        return;
    reflect(lr.dir, r, r->cos_o, r->n); /* without textures: it is aimed */
    rad_normalize(lr.dir);
    lr.source = next;
    rad_source_aimed(ctx, &lr);
    r->L = rad_rgb_mul(lr.L, lr.coef);
}

/* Reflect a ray that is not relayed. */
static void
show(struct rad_ctx *ctx, const struct rad_rgb *coef, struct rad_ray *r)
{
    bool plain = r->path & RAD_RAY_AMBIENT || !rad_ray_perturbed(r);
    struct rad_ray lr;
    double norm[3], cosine;

    if (!rad_ray_spawn(ctx, &lr, RAD_RAY_REFLECTED, r, coef,
                       RAD_BRANCH_REFLECT))
        return;
    reflect(lr.dir, r, r->cos_o, r->n);
    if (!plain) {
        double dir[3];

        cosine = rad_ray_normal(r, norm);
        reflect(dir, r, cosine, norm);
        if (rad_dot(dir, r->n) > RAD_TINY) /* not into the mirror */
            rad_copy(lr.dir, dir);
    }
    rad_ray_mirror(ctx, r, &lr, plain && rad_ray_on_flat(ctx, r));
}

bool
rad_mirror_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                 struct rad_ray *r)
{
    const struct mirror *m = mat->data;
    const struct rad_sources *s = ctx->job->sources;
    int32_t next = -1; /* what the mirror shows to a ray aimed at its image */
    struct rad_rgb coef;

    if (r->source >= 0 && rad_source_object(s, r->source) == r->hit.obj)
        next = rad_source_shown(s, r->source);
    if (m->replaced && next < 0) {
        bool safe =
            r->cos_o < 0 || !(r->path & (RAD_RAY_AMBIENT | RAD_RAY_SPECULAR));

        if (m->alternate != RAD_VOID && (safe || m->see_through))
            return rad_ray_shade(ctx, r, m->alternate);
        if (m->alternate == RAD_VOID && safe) {
            rad_ray_transmit(ctx, r);
            return true;
        }
    }
    if (r->source >= 0 && next < 0)
        return true; /* a shadow ray to another target: it is blocked */
    if (r->cos_o < 0) {
        if (!ctx->job->params.backvis)
            rad_ray_transmit(ctx, r);
        return true;
    }
    rad_ray_texture(ctx, r, mat->next);
    coef = rad_rgb_mul(m->color, r->pattern);
    if (next >= 0)
        relay(ctx, &coef, r, next);
    else
        show(ctx, &coef, r);
    return true;
}
