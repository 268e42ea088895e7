/* mist.c - see mist.h
 *
 * Rays carry a chain of the media that they are in, one link for each mist that
 * they have entered, the innermost first.  A link is on the stack of the shader
 * that made it, which lives as long as the rays that see it.  Leaving a mist
 * takes out its link, wherever that is in the chain, so mists may overlap; what
 * the others add stays.  The innermost that states an albedo or eccentricity
 * has its way.
 *
 * As in Radiance a ray that leaves a mist it has not entered must have started
 * inside.  If that mist names sources, the ray is charged for its way then, for
 * it may be all that shows the light; else it is left as it is, for those rays
 * that end inside would not know.
 *
 * In-scattering: each source that lights the medium is sampled at -ms apart
 * along the ray, at most 16 times, as in Radiance; each sample is a random
 * place in its stretch.  One shadow ray goes from there to the source, which is
 * not divided.  It is dimmed by absorption alone, as what scatters out of it is
 * taken to be made up for by what scatters in.
 * With s the distance, L gains the integral over the way of
 *     albedo ext exp(-ext s) p(angle) L_source omega ds,
 *     p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)).  */
#include "config.h"

#include "shade/mist.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/source.h"

#include <string.h>

/* Samples of one source along one ray at most, as in Radiance. */
#define MAX_SAMPLES 16

/* Between the names of a relayed source and of what relays it. */
#define RELAY '>'

struct rad_mist {
    struct rad_rgb ext, albedo;
    float g;
    bool has_ext, has_albedo, has_g;
    int32_t nlights;
    int32_t *lights; /* sources or images, see rad_sources_targets() */
};

int
rad_mist_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    const double *a = o->reals;
    int code = rad_material_reals(job, index, 0, 7, err);
    struct rad_mist *m;

    (void)files;
    if (code < 0)
        return code;
    m = rad_arena_calloc(&job->arena, 1, sizeof *m);
    if (!m)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    m->has_ext = o->nreals >= 3;
    m->has_albedo = o->nreals >= 6;
    m->has_g = o->nreals >= 7;
    if (m->has_ext)
        m->ext = rad_rgb((float)a[0], (float)a[1], (float)a[2]);
    if (m->has_albedo)
        m->albedo = rad_rgb((float)a[3], (float)a[4], (float)a[5]);
    if (m->has_g)
        m->g = (float)a[6];
    *data = m;
    return 0;
}

/* --- the sources that a mist names --- */

static const char *
object_name(const struct rad_job *job, int32_t source)
{
    int32_t obj = rad_source_object(job->sources, source);

    return job->scene->objects[obj].name;
}

/* Is source i what `name` says: a surface, or a mirror's and, behind '>', what
 * that mirror shows? */
static bool
is_named(const struct rad_job *job, int32_t i, const char *name)
{
    const char *end;

    while ((end = strchr(name, RELAY)) != NULL) {
        const char *mirror = object_name(job, i);
        size_t n = (size_t)(end - name);

        if (strncmp(name, mirror, n) != 0 || mirror[n] != '\0')
            return false;
        i = rad_source_shown(job->sources, i);
        if (i < 0)
            return false;
        name = end + 1;
    }
    return rad_source_shown(job->sources, i) < 0 &&
           strcmp(name, object_name(job, i)) == 0;
}

static bool
has(const int32_t *list, int32_t n, int32_t x)
{
    for (int32_t i = 0; i < n; i++)
        if (list[i] == x)
            return true;
    return false;
}

/* As in Radiance the last of several with one name counts, and a name that no
 * source has is none. */
static int
find_lights(struct rad_job *job, struct rad_mist *m, const struct rad_object *o,
            struct rad_error *err)
{
    m->lights =
        rad_arena_calloc(&job->arena, (size_t)o->nstrings, sizeof *m->lights);
    if (!m->lights)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (int32_t k = 0; k < o->nstrings; k++) {
        int32_t i = rad_sources_targets(job->sources);

        while (--i >= 0 && !is_named(job, i, o->strings[k]))
            ;
        if (i >= 0 && !has(m->lights, m->nlights, i))
            m->lights[m->nlights++] = i;
    }
    return 0;
}

int
rad_mists_resolve(struct rad_job *job, struct rad_error *err)
{
    const struct rad_params *p = &job->params;
    const struct rad_scene *scene = job->scene;
    struct rad_medium *own;

    if (!rad_rgb_black(p->salbedo)) {
        own = rad_arena_calloc(&job->arena, 1, sizeof *own);
        if (!own)
            return rad_fail(err, RAD_ENOMEM, "out of memory");
        own->ext = own->own_ext = p->cextinction;
        own->albedo = p->salbedo;
        own->g = (float)p->seccg;
        job->medium = own;
    }
    for (int32_t i = 0; i < scene->nobjects; i++) {
        const struct rad_object *o = &scene->objects[i];
        struct rad_mist *m;
        int code;

        if (o->type != RAD_MIST || o->nstrings == 0 || !job->materials[i].data)
            continue;
        /* the job is still being made, and this is its own */
        m = (struct rad_mist *)job->materials[i].data;
        code = find_lights(job, m, o, err);
        if (code < 0)
            return code;
    }
    return 0;
}

/* --- the chain of media --- */

/* Put what link's mist says on top of what is about it.  False: out of
 * memory. */
static bool
add_link(struct rad_ctx *ctx, struct rad_medium *link,
         const struct rad_medium *outer, struct rad_rgb outer_ext)
{
    const struct rad_params *p = &ctx->job->params;
    const struct rad_mist *m = link->mist;
    int32_t n = outer ? outer->nlights : 0;

    link->outer = outer;
    link->outer_ext = outer_ext;
    link->ext = rad_rgb_add(outer_ext, link->own_ext);
    link->albedo = m->has_albedo ? m->albedo
                   : outer       ? outer->albedo
                                 : p->salbedo;
    link->g = m->has_g ? m->g : outer ? outer->g : (float)p->seccg;
    link->nlights = n;
    link->lights = outer ? outer->lights : NULL;
    if (m->nlights == 0)
        return true;
    link->lights =
        rad_arena_alloc(&ctx->scratch, (size_t)(n + m->nlights) * sizeof n);
    if (!link->lights)
        return false;
    if (n > 0)
        memcpy(link->lights, outer->lights, (size_t)n * sizeof n);
    for (int32_t k = 0; k < m->nlights; k++)
        if (!has(link->lights, n, m->lights[k]))
            link->lights[link->nlights++] = m->lights[k];
    return true;
}

static const struct rad_medium *
find_link(const struct rad_medium *chain, const struct rad_mist *m)
{
    while (chain && chain->mist != m)
        chain = chain->solid ? NULL : chain->outer;
    return chain;
}

/* The chain without one of its links, and its extinction; copies of the links
 * that are further in go to scratch memory. */
static const struct rad_medium *
without(struct rad_ctx *ctx, const struct rad_medium *chain,
        const struct rad_medium *link, struct rad_rgb *ext)
{
    const struct rad_medium *outer;
    struct rad_medium *copy;

    if (chain == link) {
        *ext = link->outer_ext;
        return link->outer;
    }
    outer = without(ctx, chain->outer, link, ext);
    copy = rad_arena_alloc(&ctx->scratch, sizeof *copy);
    if (copy) {
        *copy = *chain;
        if (!add_link(ctx, copy, outer, *ext))
            copy = NULL;
    }
    if (!copy) { /* out of memory: as if it had not been left */
        *ext = chain->ext;
        return chain;
    }
    *ext = copy->ext;
    return copy;
}

const struct rad_medium *
rad_medium_solid(struct rad_medium *link, const struct rad_medium *m)
{
    if (!m)
        return NULL;
    memset(link, 0, sizeof *link);
    link->outer = m;
    link->solid = true;
    return link;
}

const struct rad_medium *
rad_medium_about(const struct rad_job *job, const struct rad_medium *m)
{
    while (m && !m->solid)
        m = m->outer;
    return m ? m->outer : job->medium;
}

/* --- scattering --- */

static float
transmission(double ext, double t)
{
    /* exp(-0 * INFINITY) would be no number: what is clear stays so */
    return ext > 0 ? (float)exp(-ext * t) : 1;
}

static struct rad_rgb
transmission_rgb(struct rad_rgb ext, double t)
{
    struct rad_rgb T;

    T.r = transmission(ext.r, t);
    T.g = ext.g == ext.r ? T.r : transmission(ext.g, t);
    T.b = ext.b == ext.g ? T.g : transmission(ext.b, t);
    return T;
}

/* rad_brdf_fn: of what a sample of the source sends, the part that is
 * scattered toward the eye, per length and scattering coefficient. */
struct scattered {
    const double *dir; /* of the ray, from the eye */
    double g;
};

static void
phase(struct rad_rgb *coef, void *data, const double ldir[3], double omega)
{
    const struct scattered *s = data;
    double p = 1, q;

    if (s->g > RAD_TINY) {
        q = 1 + s->g * s->g - 2 * s->g * rad_dot(s->dir, ldir);
        p = (1 - s->g * s->g) / (q * sqrt(q));
    }
    *coef = rad_grey((float)(p * omega / (4 * M_PI)));
}

/* What comes by way of the place at distance t, for a stretch of length ds. */
static struct rad_rgb
scatter_at(struct rad_ctx *ctx, const struct rad_ray *r, int32_t source,
           double t, double ds, uint64_t key)
{
    const struct rad_medium *m = r->medium;
    struct scattered s = { r->dir, m->g };
    struct rad_ray at = *r; /* as if it ended there, in mid-air */
    struct rad_rgb f;

    at.key = key;
    rad_ray_clear(&at);
    at.hit.t = t;
    at.hit.err = 0;
    rad_madd(at.hit.p, r->org, t, r->dir);
    rad_scale(at.hit.n, -1, r->dir);
    rad_ray_enter(&at);
    rad_direct_from(ctx, &at, source, phase, &s);
    f = rad_rgb_mul(rad_rgb_mul(m->albedo, r->ext),
                    transmission_rgb(r->ext, t));
    return rad_rgb_mul(at.L, rad_rgb_scale(f, (float)ds));
}

static int
sample_count(const struct rad_ctx *ctx, double length)
{
    double apart = ctx->job->params.ssampdist, n = length / apart + .5;

    if (!(apart > RAD_TINY) || n < 1)
        return 1;
    return n > MAX_SAMPLES ? MAX_SAMPLES : (int)n;
}

static void
scatter(struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_medium *m = r->medium;
    double length = r->hit.t;
    int n;

    if (!(length < INFINITY) || m->g >= 1 - RAD_TINY)
        return; /* all or nothing comes straight on */
    n = sample_count(ctx, length);
    for (int32_t i = 0; i < m->nlights; i++) {
        uint64_t key = rad_key_branch(
            rad_key_branch(r->key, RAD_BRANCH_SCATTER), (uint64_t)m->lights[i]);

        for (int j = 0; j < n; j++) {
            double t = length * (j + rad_rand(key, (uint32_t)j)) / n;

            r->L = rad_rgb_add(r->L,
                               scatter_at(ctx, r, m->lights[i], t, length / n,
                                          rad_key_branch(key, (uint64_t)j)));
        }
    }
}

void
rad_mist_participate(struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_medium *m = r->medium;
    struct rad_rgb ext = r->ext, a = m->albedo, T;
    bool shadow = r->path & RAD_RAY_SHADOW;

    if (shadow && !m->solid)
        ext = rad_rgb_mul(ext, rad_rgb(1 - a.r, 1 - a.g, 1 - a.b));
    T = transmission_rgb(ext, r->hit.t);
    r->L = rad_rgb_mul(r->L, T);
    if (shadow || m->solid || rad_rgb_max(a) <= RAD_TINY)
        return;
    a = rad_rgb_mul(a, ctx->job->params.ambval);
    r->L =
        rad_rgb_add(r->L, rad_rgb_mul(a, rad_rgb(1 - T.r, 1 - T.g, 1 - T.b)));
    scatter(ctx, r);
}

/* --- the surface --- */

/* Go on in another medium. */
static void
pass(struct rad_ctx *ctx, struct rad_ray *r, const struct rad_medium *medium,
     struct rad_rgb ext)
{
    struct rad_ray tr;

    if (!rad_ray_spawn(ctx, &tr, RAD_RAY_TRANS, r, NULL, RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, r->dir);
    tr.medium = medium;
    tr.ext = ext;
    rad_ray_onward(&tr);
    rad_ray_trace(ctx, &tr);
    r->L = tr.L;
    r->L_mirror = tr.L_mirror;
    r->dist = r->hit.t + tr.dist;
    r->mirror_dist = r->hit.t + tr.mirror_dist;
}

/* The ray started inside: charge it for its way now that this is known. */
static void
settle(struct rad_ctx *ctx, struct rad_ray *r, struct rad_medium *link)
{
    const struct rad_medium *before = r->medium;

    if (!add_link(ctx, link, before, r->ext))
        return;
    r->medium = link;
    r->ext = link->ext;
    rad_mist_participate(ctx, r);
    r->medium = before;
    r->ext = rad_grey(0);
}

bool
rad_mist_shade(struct rad_ctx *ctx, const struct rad_material *mat,
               struct rad_ray *r)
{
    struct rad_medium link = { .mist = mat->data };
    const struct rad_medium *old, *rest;
    struct rad_rgb ext;
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);

    if (link.mist->has_ext) {
        rad_ray_texture(ctx, r, mat->next);
        link.own_ext = rad_rgb_mul(link.mist->ext, r->pattern);
    }
    if (r->cos_o > 0) {
        if (add_link(ctx, &link, r->medium, r->ext))
            pass(ctx, r, &link, link.ext);
    } else if ((old = find_link(r->medium, link.mist)) != NULL) {
        rest = without(ctx, r->medium, old, &ext);
        pass(ctx, r, rest, ext);
    } else {
        pass(ctx, r, r->medium, r->ext);
        if (link.mist->nlights > 0)
            settle(ctx, r, &link);
    }
    rad_arena_rewind(&ctx->scratch, mark);
    return true;
}
