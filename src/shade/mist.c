/* mist.c - see mist.h
 *
 * A ray has a chain of the media that it is in: one link for each mist that it
 * has entered, the innermost first.  A link lies on the stack of the shader
 * that made it, which lives as long as the rays that see the link.  Leaving a
 * mist takes out its link, wherever it is in the chain: so mists may overlap,
 * and the other links stay.  Albedo and eccentricity are those of the innermost
 * mist that states them.
 *
 * As in Radiance, a ray that leaves a mist which it has not entered started
 * inside.  If that mist names sources, its extinction and scattering are
 * applied to the ray's way now, since this may be all that shows the light.  If
 * it does not, nothing is applied, as for rays that start inside and end there.
 *
 * In-scattering: each source that lights the medium is sampled every -ms along
 * the ray, at most 16 times, as in Radiance; each sample is a random place in
 * its stretch.  One shadow ray goes from there to the source, which is not
 * divided.  Only absorption dims that shadow ray: light that is scattered out
 * of it is taken to be balanced by light that is scattered into it.
 * With s the distance, L gains the integral over the way of
 *     albedo ext exp(-ext s) p(angle) L_source omega ds,
 *     p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)).  */
#include "config.h"

#include "shade/mist.h"
#include "arith/expf.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/direct/source.h"

#include <stddef.h>
#include <string.h>

/* Samples of one source along one ray, at most, as in Radiance. */
#define MAX_SAMPLES 16

/* In the name of a relayed source: after the mirror, before the source. */
#define RELAY '>'

/* A compiled mist; fields as of struct rad_medium. */
struct rad_mist {
    struct rad_rgb ext, albedo;
    float g;
    bool has_ext, has_albedo, has_g; /* the arguments are given */
    int32_t nlights;
    int32_t *lights; /* numbers of sources or images (rad_sources_targets()) */
};

int
rad_mist_prepare(struct rad_job *job, int32_t index,
                 const struct rad_files *files, const void **data,
                 struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    const double *a = o->reals;
    int code;
    struct rad_mist *m =
        rad_material_begin(job, index, 0, 7, sizeof *m, &code, err);

    (void)files;
    if (!m)
        return code;
    m->has_ext = o->nreals >= 3;
    m->has_albedo = o->nreals >= 6;
    m->has_g = o->nreals >= 7;
    if (m->has_ext)
        m->ext = rad_job_colour(job, a);
    if (m->has_albedo)
        m->albedo = rad_job_colour(job, a + 3);
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

/* Does `name` mean source or image i?  A name is a surface's, or a mirror's,
 * '>', and the name of what the mirror shows. */
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

/* Find the sources that the mist's object o names.  As in Radiance the last of
 * several sources of one name counts, and a name that no source has is ignored.
 */
static int
find_lights(struct rad_job *job, struct rad_mist *m, const struct rad_object *o,
            struct rad_error *err)
{
    m->lights =
        rad_arena_calloc(&job->arena, (size_t)o->nstrings, sizeof *m->lights);
    if (!m->lights)
        return rad_fail_memory(err);
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
            return rad_fail_memory(err);
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
        /* the cast drops const: the job is still being made */
        m = (struct rad_mist *)job->materials[i].data;
        code = find_lights(job, m, o, err);
        if (code < 0)
            return code;
    }
    return 0;
}

/* --- the chain of media --- */

/* Let link have the lights of `outer` and of its own mist.  False: out of
 * memory. */
static bool
add_lights(struct rad_ctx *ctx, struct rad_medium *link,
           const struct rad_medium *outer)
{
    const struct rad_mist *m = link->mist;
    int32_t *all, n = outer->nlights;

    all = rad_arena_alloc(&ctx->scratch, (size_t)(n + m->nlights) * sizeof n);
    if (!all)
        return false;
    memcpy(all, outer->lights, (size_t)n * sizeof n);
    for (int32_t k = 0; k < m->nlights; k++)
        if (!has(all, n, m->lights[k]))
            all[link->nlights++] = m->lights[k];
    link->lights = all;
    return true;
}

/* Set link's fields by its mist, within the medium `outer` (NULL: none), whose
 * extinction is *outer_ext.  False: out of memory. */
static bool
add_link(struct rad_ctx *ctx, struct rad_medium *link,
         const struct rad_medium *outer, const struct rad_rgb *outer_ext)
{
    const struct rad_params *p = &ctx->job->params;
    const struct rad_mist *m = link->mist;
    bool lit = outer && outer->nlights > 0;

    link->outer = outer;
    link->outer_ext = *outer_ext;
    link->ext = rad_rgb_add(*outer_ext, link->own_ext);
    link->albedo = m->has_albedo ? m->albedo
                   : outer       ? outer->albedo
                                 : p->salbedo;
    link->g = m->has_g ? m->g : outer ? outer->g : (float)p->seccg;
    link->nlights = lit ? outer->nlights : m->nlights;
    link->lights = lit ? outer->lights : m->lights;
    return !lit || m->nlights == 0 || add_lights(ctx, link, outer);
}

/* The link of mist m in the chain, up to a solid; NULL: there is none. */
static const struct rad_medium *
find_link(const struct rad_medium *chain, const struct rad_mist *m)
{
    while (chain && chain->mist != m)
        chain = chain->solid ? NULL : chain->outer;
    return chain;
}

/* The chain without one of its links; *ext gets its extinction.  Links further
 * in are copied to scratch memory. */
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
        if (!add_link(ctx, copy, outer, ext))
            copy = NULL;
    }
    if (!copy) { /* out of memory: as if the ray had not left the mist */
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

/* The transmittance for extinction ext over length t.
 * Inline, since a call would return three floats in two registers by way of
 * memory, and wait for that. */
static inline __attribute__((always_inline)) struct rad_rgb
transmission(struct rad_rgb ext, double t)
{
    /* a clear channel stays 1: exp(-0 * INFINITY) would be NaN */
    double r = ext.r > 0 ? -ext.r * t : 0, b = ext.b > 0 ? -ext.b * t : 0;
    struct rad_rgb T;

    rad_expf2(r, b, &T.r, &T.b);
    T.g = ext.g == ext.r   ? T.r
          : ext.g == ext.b ? T.b
          : ext.g > 0      ? rad_expf(-ext.g * t)
                           : 1;
    return T;
}

/* The data of phase(). */
struct scattered {
    const double *dir; /* of the ray, from the eye */
    double g;
};

/* rad_brdf_fn: the part of a light sample's radiance that is scattered toward
 * the eye, per length and scattering coefficient. */
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

/* Copy r's way to *to.  The fields for what r meets and brings back are not
 * copied: they are most of a ray. */
static void
follow(struct rad_ray *to, const struct rad_ray *r)
{
    memcpy(to, r, offsetof(struct rad_ray, hit));
}

/* The light of a source that r's medium scatters into r, along a stretch of
 * length ds about the place p at distance t. */
static struct rad_rgb
scatter_at(struct rad_ctx *ctx, const struct rad_ray *r, int32_t source,
           const double p[3], double t, double ds, uint64_t key)
{
    const struct rad_medium *m = r->medium;
    struct scattered s = { r->dir, m->g };
    struct rad_ray at; /* r as if it ended at p, in the air */
    struct rad_rgb f;

    follow(&at, r);
    at.key = key;
    rad_ray_clear(&at);
    at.hit.t = t;
    at.hit.err = 0;
    at.hit.uv[0] = at.hit.uv[1] = 0;
    rad_copy(at.hit.p, p);
    rad_scale(at.hit.n, -1, r->dir);
    rad_ray_enter(&at);
    rad_direct_from(ctx, &at, source, phase, &s);
    if (rad_rgb_black(at.L))
        return at.L;
    f = rad_rgb_mul(rad_rgb_mul(m->albedo, r->ext), transmission(r->ext, t));
    return rad_rgb_mul(at.L, rad_rgb_scale(f, ds));
}

static int
sample_count(const struct rad_ctx *ctx, double length)
{
    double apart = ctx->job->params.ssampdist, n = length / apart + .5;

    if (!(apart > 0) || n < 1)
        return 1;
    return n > MAX_SAMPLES ? MAX_SAMPLES : (int)n;
}

/* Add to r->L the light of sources that r's medium scatters into r. */
static void
scatter(struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_medium *m = r->medium;
    double length = r->hit.t, p[3];
    int n = r->sample > 0 ? 1 : sample_count(ctx, length);

    for (int32_t i = 0; i < m->nlights; i++) {
        uint64_t key = rad_key_branch(
            rad_key_branch(r->key, RAD_BRANCH_SCATTER), (uint64_t)m->lights[i]);

        for (int j = 0; j < n; j++) {
            double t = length * (j + rad_rand(key, (uint32_t)j)) / n;

            rad_madd(p, r->org, t, r->dir);
            if (rad_source_reaches(ctx->job->sources, m->lights[i], p))
                r->L = rad_rgb_add(
                    r->L, scatter_at(ctx, r, m->lights[i], p, t, length / n,
                                     rad_key_branch(key, (uint64_t)j)));
        }
    }
}

/* Let a medium (NULL: one that does not scatter) dim *L along a stretch of
 * length t, and add the light that it scatters of the ambient value.  True: it
 * scatters light of sources, too, which scatter() adds. */
static bool
dim(const struct rad_ctx *ctx, const struct rad_medium *m,
    const struct rad_rgb *extinction, double t, bool shadow, struct rad_rgb *L)
{
    bool scatters = m && !m->solid;
    struct rad_rgb a, T, ext = *extinction;

    if (shadow && scatters) {
        a = m->albedo;
        ext = rad_rgb_mul(ext, rad_rgb(1 - a.r, 1 - a.g, 1 - a.b));
    }
    T = transmission(ext, t);
    *L = rad_rgb_mul(*L, T);
    if (shadow || !scatters || rad_rgb_max(m->albedo) <= RAD_TINY)
        return false;
    a = rad_rgb_mul(m->albedo, ctx->job->params.ambval);
    *L = rad_rgb_add(*L, rad_rgb_mul(a, rad_rgb(1 - T.r, 1 - T.g, 1 - T.b)));
    /* with eccentricity 1 light is scattered straight on: no sample meets it */
    return m->nlights > 0 && t < INFINITY && m->g < 1 - RAD_TINY;
}

void
rad_mist_participate(struct rad_ctx *ctx, struct rad_ray *r)
{
    if (dim(ctx, r->medium, &r->ext, r->hit.t, r->path & RAD_RAY_SHADOW, &r->L))
        scatter(ctx, r);
}

/* --- the surface --- */

/* A stretch of a ray from one boundary to the next: the fields of the ray that
 * differ from stretch to stretch. */
struct stretch {
    double org[3], t;
    uint64_t key;
    float weight;
    uint16_t depth;
    struct rad_rgb ext;
    const struct rad_medium *medium;
    struct rad_medium link; /* link of the mist that begins at its end */
};

/* A ray's way from one boundary of a mist through the boundaries that follow,
 * without other surfaces between them. */
struct passage {
    struct stretch way[RAD_LINE_MOST];
    int n;
    bool dead;           /* no ray goes on behind the last boundary */
    double length;       /* of all stretches */
    struct rad_ray last; /* the ray of the last stretch */
};

/* The mist whose boundary is surface i of a line, if the mist has no pattern;
 * NULL: the surface is another. */
static const struct rad_mist *
mist_of(const struct rad_job *job, const struct rad_line *line, int i)
{
    int32_t obj = rad_geom_ahead(job->geom, line, i), mod;
    const struct rad_material *mat;

    if (obj == RAD_VOID || job->cut)
        return NULL;
    mod = job->scene->objects[obj].modifier;
    if (mod == RAD_VOID)
        return NULL;
    mat = &job->materials[mod];
    return mat->shader && mat->shader->type == RAD_MIST && mat->next == RAD_VOID
               ? mat->data
               : NULL;
}

/* The same for the next surface on r's way. */
static const struct rad_mist *
next_mist(const struct rad_ctx *ctx, const struct rad_ray *r)
{
    return r->line ? mist_of(ctx->job, r->line, r->line_at) : NULL;
}

/* A ray enters m, or leaves it if `old` is m's link.  Sets *medium and *ext to
 * those behind the boundary.  False: out of memory. */
static bool
cross(struct rad_ctx *ctx, const struct rad_mist *m,
      const struct rad_medium *old, struct rad_medium *link,
      const struct rad_medium **medium, struct rad_rgb *ext)
{
    if (old) {
        *medium = without(ctx, *medium, old, ext);
        return true;
    }
    link->mist = m;
    link->solid = false;
    link->own_ext = m->ext;
    if (!add_link(ctx, link, *medium, ext))
        return false;
    *medium = link;
    *ext = link->ext;
    return true;
}

/* A ray that started in m leaves it at the end of s: apply m to the stretch, as
 * settle() does. */
static bool
settle_stretch(struct rad_ctx *ctx, const struct rad_mist *m, struct stretch *s)
{
    return m->nlights == 0 ||
           cross(ctx, m, NULL, &s->link, &s->medium, &s->ext);
}

/* Go to the next boundary, which is m's, and through it.  *medium and *ext are
 * those on the way there, and become those behind it.  False: it is not sure
 * what comes next. */
static bool
go_through(struct rad_ctx *ctx, struct passage *p, const struct rad_mist *m,
           const struct rad_medium **medium, struct rad_rgb *ext)
{
    const struct rad_medium *old;
    struct rad_ray *r = &p->last;
    struct stretch *s = &p->way[p->n];
    double before = r->hit.t;

    rad_geom_leave(&r->hit, r->dir, s->org);
    if (rad_geom_beyond(ctx->job->geom, r->line, r->line_at, &r->hit, s->org,
                        r->dir, &r->hit) != RAD_BEYOND_MET)
        return false;
    s->t = r->hit.t;
    r->hit.t = before;
    p->dead = !rad_ray_go_on(ctx, r);
    r->hit.t = s->t;
    if (p->dead)
        return true;
    ctx->counts.rays++;
    r->line_at++;
    r->ext = s->ext = *ext;
    s->medium = *medium;
    s->key = r->key;
    s->weight = r->weight;
    s->depth = r->depth;
    p->length += s->t;
    p->n++;
    old = find_link(*medium, m);
    if (-rad_dot(r->dir, r->hit.n) > 0)
        p->dead = !cross(ctx, m, NULL, &s->link, medium, ext);
    else if (old)
        p->dead = !cross(ctx, m, old, &s->link, medium, ext);
    else
        p->dead = !settle_stretch(ctx, m, s);
    return true;
}

/* Go on from r's hit through all boundaries of mists that come next on r's
 * line.  *medium and *ext as in go_through().  NULL: none comes next, or memory
 * is out. */
static struct passage *
go_far(struct rad_ctx *ctx, const struct rad_ray *r,
       const struct rad_medium **medium, struct rad_rgb *ext)
{
    const struct rad_mist *m = next_mist(ctx, r);
    struct passage *p = m ? rad_arena_alloc(&ctx->scratch, sizeof *p) : NULL;

    if (!p)
        return NULL;
    p->n = 0;
    p->dead = false;
    p->length = 0;
    follow(&p->last, r);
    p->last.parent = r;
    p->last.hit = r->hit;
    while (m && go_through(ctx, p, m, medium, ext) && !p->dead)
        m = next_mist(ctx, &p->last);
    return p->n > 0 || p->dead ? p : NULL;
}

/* Make *at the ray of stretch s. */
static void
return_to(struct rad_ray *at, const struct stretch *s)
{
    rad_copy(at->org, s->org);
    at->hit.t = s->t;
    at->key = s->key;
    at->weight = s->weight;
    at->depth = s->depth;
    at->ext = s->ext;
    at->medium = s->medium;
}

/* Bring r->L, the light from behind the last boundary, back to r's hit through
 * all stretches. */
static void
come_back(struct rad_ctx *ctx, struct rad_ray *r, struct passage *p)
{
    bool shadow = r->path & RAD_RAY_SHADOW;
    struct rad_rgb L = r->L;
    double met = r->hit.t, before = p->length;

    while (p->n > 0) {
        const struct stretch *s = &p->way[--p->n];

        before -= s->t;
        if (rad_rgb_black(s->ext) ||
            !dim(ctx, s->medium, &s->ext, s->t, shadow, &L))
            continue;
        r->hit.t = met + before; /* r stands for all stretches before s */
        return_to(&p->last, s);
        p->last.L = L;
        scatter(ctx, &p->last);
        L = p->last.L;
    }
    r->hit.t = met;
    r->L = L;
}

/* Set r->L to the light from behind r's hit, or from behind the passage's last
 * boundary. */
static void
trace_behind(struct rad_ctx *ctx, struct rad_ray *r,
             const struct rad_medium *medium, const struct rad_rgb *ext,
             struct passage *p)
{
    double met = r->hit.t, length = p ? p->length : 0;
    struct rad_ray tr;

    if (p)
        r->dist = met + length;
    if ((p && p->dead) ||
        !rad_ray_spawn(ctx, &tr, RAD_RAY_TRANS, p ? &p->last : r, NULL,
                       RAD_BRANCH_TRANSMIT))
        return;
    rad_copy(tr.dir, r->dir);
    tr.medium = medium;
    tr.ext = *ext;
    rad_ray_onward(&tr);
    if (p) /* r stands for all stretches but the last */
        r->hit.t = met + length - p->last.hit.t;
    rad_ray_trace(ctx, &tr);
    r->hit.t = met;
    r->L = tr.L;
    r->L_mirror = tr.L_mirror;
    r->dist = met + length + tr.dist;
    r->mirror_dist = met + length + tr.mirror_dist;
}

/* Pass the ray on in another medium. */
static void
pass(struct rad_ctx *ctx, struct rad_ray *r, const struct rad_medium *medium,
     const struct rad_rgb *behind)
{
    struct rad_rgb ext = *behind;
    struct passage *p = go_far(ctx, r, &medium, &ext);

    trace_behind(ctx, r, medium, &ext, p);
    if (p)
        come_back(ctx, r, p);
}

struct rad_rgb
rad_mist_veil(const struct rad_ctx *ctx, const struct rad_medium *m,
              struct rad_rgb ext, double t)
{
    struct rad_rgb T = rad_grey(1);

    if (!rad_rgb_black(ext))
        dim(ctx, m, &ext, t, true, &T);
    return T;
}

/* rad_mist_veils(); the caller rewinds the scratch memory. */
static bool
look_through(struct rad_ctx *ctx, const struct rad_ray *r,
             const struct rad_span *span, const struct rad_line *line,
             struct rad_rgb *T)
{
    const struct rad_job *job = ctx->job;
    struct rad_medium link[RAD_LINE_MOST];
    const struct rad_medium *medium = r->medium;
    struct rad_rgb ext = r->ext;
    double from = 0;

    *T = rad_grey(1);
    for (int i = 0; i < line->n; i++) {
        const struct rad_medium *old;
        const struct rad_mist *m;

        if (!rad_rgb_black(ext))
            dim(ctx, medium, &ext, line->at[i].t - from, true, T);
        from = line->at[i].t;
        if (i == line->n - 1)
            break;
        m = mist_of(job, line, i);
        if (!m)
            return false;
        old = find_link(medium, m);
        if (rad_geom_faces(job->geom, line, i, span))
            old = NULL;
        else if (!old)
            return false; /* the ray started inside m */
        if (!cross(ctx, m, old, &link[i], &medium, &ext))
            return false;
    }
    return true;
}

bool
rad_mist_veils(struct rad_ctx *ctx, const struct rad_ray *r,
               const struct rad_span *span, const struct rad_line *line,
               struct rad_rgb *T)
{
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    bool ok = look_through(ctx, r, span, line, T);

    rad_arena_rewind(&ctx->scratch, mark);
    if (ok) /* count as if each stretch had been a ray */
        ctx->counts.rays += (uint64_t)line->n - 1;
    return ok;
}

/* The ray started inside link's mist, as is known now: apply the mist to its
 * way. */
static void
settle(struct rad_ctx *ctx, struct rad_ray *r, struct rad_medium *link)
{
    const struct rad_medium *before = r->medium;

    if (!add_link(ctx, link, before, &r->ext))
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
        if (add_link(ctx, &link, r->medium, &r->ext))
            pass(ctx, r, &link, &link.ext);
    } else if ((old = find_link(r->medium, link.mist)) != NULL) {
        rest = without(ctx, r->medium, old, &ext);
        pass(ctx, r, rest, &ext);
    } else {
        pass(ctx, r, r->medium, &r->ext);
        if (link.mist->nlights > 0)
            settle(ctx, r, &link);
    }
    rad_arena_rewind(&ctx->scratch, mark);
    return true;
}
