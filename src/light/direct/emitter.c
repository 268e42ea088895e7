/* emitter.c - what a ray sees that meets a light, illum, glow or spotlight
 *
 * Direct light is gathered by shadow rays that aim at sources
 * (light/direct/source.h).  A ray that meets a source by chance must not count
 * its light again: indirect diffuse and glossy rays see black there, and so
 * does a shadow ray that aims at another source.  Seen by the eye, in mirrors
 * and through glass, sources are bright.
 * An illum stands for the light that comes from behind it.  A shadow ray that
 * aims at the illum sees a source; all other rays see its alternate material,
 * or pass it. */
#include "config.h"

#include "light/direct/emitter.h"
#include "light/direct/source.h"

int
rad_emitter_prepare(struct rad_job *job, int32_t index,
                    const struct rad_files *files, const void **data,
                    struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    int n = o->type == RAD_GLOW ? 4 : o->type == RAD_SPOTLIGHT ? 7 : 3;
    int code;
    struct rad_emitter *e =
        rad_material_begin(job, index, n, n, sizeof *e, &code, err);

    (void)files;
    if (!e)
        return code;
    e->type = o->type;
    e->L = rad_job_colour(job, o->reals);
    e->radius = o->type == RAD_GLOW ? o->reals[3] : INFINITY;
    if (o->type == RAD_SPOTLIGHT && !rad_spot_init(&e->spot, o->reals))
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "spotlight without angle or direction");
    *data = e;
    e->alternate = RAD_VOID;
    if (o->type != RAD_ILLUM || o->nstrings == 0)
        return 0;
    return rad_scene_named(job->scene, index, 0, &e->alternate, err);
}

const struct rad_emitter *
rad_emitter_of(const struct rad_job *job, int32_t obj)
{
    const struct rad_object *o = &job->scene->objects[obj];
    const struct rad_material *mat;
    int32_t m;

    if (!rad_otype_is_surface(o->type))
        return NULL;
    m = rad_material_of(job->scene, o->modifier);
    if (m == RAD_VOID)
        return NULL;
    mat = &job->materials[m];
    return mat->shader->flags & RAD_MAT_EMITS ? mat->data : NULL;
}

/* The object that a ray is aimed at (RAD_VOID: none), and the one it met. */
struct aim {
    int32_t target, met;
};

static struct aim
aim_of(const struct rad_ctx *ctx, const struct rad_ray *r)
{
    const struct rad_sources *s = ctx->job->sources;
    struct aim a = { RAD_VOID, r->hit.obj };

    if (r->source >= 0)
        a.target = rad_source_object(s, r->source);
    if (r->far_source >= 0)
        a.met = rad_source_object(s, r->far_source);
    return a;
}

/* Is this a glow that is too far away, at distance d, to be a source? */
static bool
far_glow(const struct rad_emitter *e, double d)
{
    return e->type == RAD_GLOW && e->radius >= -RAD_TINY && d > e->radius;
}

/* Does a shadow ray count the emitter's light in place of r?  Yes, if r is an
 * indirect or glossy ray that meets the front of a source. */
static bool
counted_already(const struct rad_emitter *e, const struct rad_ray *r)
{
    if (!(r->path & (RAD_RAY_AMBIENT | RAD_RAY_SPECULAR)))
        return false;
    return !(r->path & RAD_RAY_SHADOW || r->cos_o < 0 || far_glow(e, r->hit.t));
}

/* Does the emitter stop a shadow ray that aims at another source?  Only an
 * illum lets it pass: from behind always, from the front if the other source is
 * a light or spotlight.  (An illum or glow stands for the light from behind it,
 * which the illum in front of it already stands for.) */
static bool
in_the_way(const struct rad_ctx *ctx, const struct rad_emitter *e,
           const struct rad_ray *r, const struct aim *a)
{
    const struct rad_emitter *target;

    if (a->target == RAD_VOID || a->target == a->met)
        return false;
    if (e->type != RAD_ILLUM)
        return true;
    target = rad_emitter_of(ctx->job, a->target);
    return r->cos_o > 0 && target &&
           (target->type == RAD_ILLUM || target->type == RAD_GLOW);
}

/* Is the ray aimed at the source that it met?  Not if that object is a mirror,
 * too, and the ray is aimed at an image in it. */
static bool
aimed_at(const struct rad_ctx *ctx, const struct rad_ray *r,
         const struct aim *a)
{
    return a->target == a->met &&
           (r->source < 0 ||
            rad_source_shown(ctx->job->sources, r->source) < 0);
}

/* Does -dv- hide the emitter?  It hides sources from all rays but shadow rays;
 * a glow that is too far away, along the whole path, is no source. */
static bool
hidden(const struct rad_ctx *ctx, const struct rad_emitter *e,
       const struct rad_ray *r)
{
    double way = 0;

    if (ctx->job->params.directvis || r->path & RAD_RAY_SHADOW)
        return false;
    for (; r; r = r->parent)
        way += r->hit.t;
    return !far_glow(e, way);
}

bool
rad_emitter_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r)
{
    const struct rad_emitter *e = mat->data;
    struct aim a;

    if (counted_already(e, r))
        return true;
    a = aim_of(ctx, r);
    if (in_the_way(ctx, e, r, &a))
        return true;
    if (e->type == RAD_ILLUM && !aimed_at(ctx, r, &a)) {
        if (e->alternate != RAD_VOID)
            return rad_ray_shade(ctx, r, e->alternate);
        rad_ray_transmit(ctx, r);
        return true;
    }
    if (hidden(ctx, e, r))
        return true;
    if (r->cos_o < 0) { /* its back is black, or invisible with -bv- */
        if (!ctx->job->params.backvis)
            rad_ray_transmit(ctx, r);
        return true;
    }
    if (e->type == RAD_SPOTLIGHT && rad_spot_outside(&e->spot, r->dir))
        return true;
    rad_ray_texture(ctx, r, mat->next);
    r->L = rad_rgb_mul(e->L, r->pattern);
    return true;
}
