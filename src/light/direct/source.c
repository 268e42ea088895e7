/* source.c - see source.h
 *
 * Finds the light sources of a scene, and the distant source that a ray meets
 * if it meets no surface.  Where sources are sampled is in light/sample, their
 * shapes are in shape.c, and which of them a point sees in shadow.c.  */
#include "config.h"

#include "light/direct/sources.h"
#include "base/vec.h"
#include "scene/part.h"
#include "light/direct/cover.h"
#include "light/direct/emitter.h"

#include <float.h>

/* Does obj have its emitter's radiance everywhere: is there no pattern or
 * texture on it? */
static bool
is_plain(const struct rad_job *job, int32_t obj)
{
    int32_t first = job->scene->objects[obj].modifier;
    int32_t mat = rad_material_of(job->scene, first);

    for (int32_t m = first; m != RAD_VOID; m = job->materials[m].next)
        if (m != mat && job->materials[m].shader)
            return false;
    return true;
}

/* Does any of a spotlight's cone leave the front of a flat source? */
static bool
spot_shines(const struct rad_spot *spot, const double normal[3])
{
    double d = rad_dot(spot->aim, normal);
    double cone = 1 - spot->omega / (2 * M_PI); /* cosine of its half angle */

    return d > 0 || cone < 0 || cone * cone < 1 - d * d;
}

/* Fill in *src for obj, whose material is em.  0, 1 if obj is no source, or a
 * negative code. */
static int
make_source(struct rad_source *src, struct rad_job *job, int32_t obj,
            const struct rad_emitter *em, struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[obj];
    bool far = o->type == RAD_SOURCE;
    bool glow = em->type == RAD_GLOW;
    int rc;

    if (rad_rgb_black(em->L) || (glow && !far && !(em->radius > 0)) ||
        o->type == RAD_INSTANCE || o->type == RAD_MESH)
        return 1;
    *src = (struct rad_source){ .obj = obj, .L = em->L, .spot = em->spot };
    rc = rad_light_shape(src, o, &job->arena);
    if (rc == RAD_EDATA)
        return rad_scene_fail(job->scene, o, err, rc,
                              "a %s cannot be a light source",
                              rad_otype_name(o->type));
    if (rc < 0)
        return rad_fail(err, rc, "out of memory");
    if (rc > 0)
        return 1;
    if (glow) {
        src->flags |= far ? RAD_LIGHT_SKIP : RAD_LIGHT_NEAR;
        src->reach = em->radius;
    }
    if (em->type == RAD_SPOTLIGHT) {
        src->flags |= RAD_LIGHT_SPOT;
        rad_light_set_apex(src);
        if (src->flags & RAD_LIGHT_FLAT &&
            !spot_shines(&src->spot, src->normal))
            src->flags |= RAD_LIGHT_SKIP;
    }
    if (em->type == RAD_ILLUM && em->alternate == RAD_VOID)
        src->flags |= RAD_LIGHT_PASSES;
    if (is_plain(job, obj))
        src->flags |= RAD_LIGHT_PLAIN;
    return 0;
}

/* Room for all sources that the scene may have; NULL: memory is out. */
static struct rad_sources *
make_room(struct rad_job *job)
{
    struct rad_sources *s = rad_arena_calloc(&job->arena, 1, sizeof *s);
    size_t emitters = 0;

    for (int32_t i = 0; i < rad_scene_own(job->scene); i++)
        if (rad_emitter_of(job, i))
            emitters++;
    if (!s)
        return NULL;
    s->list = rad_arena_calloc(&job->arena, emitters, sizeof *s->list);
    s->distant = rad_arena_calloc(&job->arena, emitters, sizeof *s->distant);
    return s->list && s->distant ? s : NULL;
}

static void
count(struct rad_sources *s, double shadcert)
{
    for (int32_t i = 0; i < s->n; i++) {
        if (s->list[i].flags & RAD_LIGHT_DISTANT)
            s->distant[s->ndistant++] = i;
        if (!(s->list[i].flags & RAD_LIGHT_SKIP))
            s->nlit++;
    }
    for (int32_t n = 0; n < RAD_FEW_SAMPLES; n++)
        s->share[n] = rad_share_of(n, shadcert);
}

/* As in Radiance, emitters inside instances and meshes are seen by rays, but
 * are no sources. */
struct rad_sources *
rad_sources_new(struct rad_job *job, struct rad_error *err)
{
    struct rad_sources *s = make_room(job);

    if (!s) {
        rad_fail_memory(err);
        return NULL;
    }
    for (int32_t i = 0; i < rad_scene_own(job->scene); i++) {
        const struct rad_emitter *em = rad_emitter_of(job, i);
        struct rad_source *src = &s->list[s->n];
        int rc = em ? make_source(src, job, i, em, err) : 1;

        if (rc < 0)
            return NULL;
        if (rc == 0)
            s->n++;
    }
    if (!rad_drop_covered(job, s->list, &s->n, sizeof *s->list,
                          offsetof(struct rad_source, obj))) {
        rad_fail_memory(err);
        return NULL;
    }
    count(s, job->params.shadcert);
    return s;
}

int32_t
rad_source_object(const struct rad_sources *s, int32_t i)
{
    return rad_source_target(s, i);
}

int32_t
rad_source_shown(const struct rad_sources *s, int32_t i)
{
    return i < s->n ? -1 : s->virtuals[i - s->n].from;
}

int32_t
rad_source_way(const struct rad_sources *s, int32_t i)
{
    return i < s->n ? 0 : s->virtuals[i - s->n].way;
}

void
rad_source_toward(const struct rad_sources *s, int32_t i, const double p[3],
                  double dir[3])
{
    const struct rad_virtual *v = i < s->n ? NULL : &s->virtuals[i - s->n];
    const struct rad_source *src = &s->list[v ? v->root : i];

    rad_copy(dir, v ? v->image : src->centre);
    if (src->flags & RAD_LIGHT_DISTANT)
        return;
    rad_sub(dir, dir, p);
    rad_normalize(dir);
}

bool
rad_source_reaches(const struct rad_sources *s, int32_t i, const double p[3])
{
    return i >= s->n || rad_light_reaches(&s->list[i], p);
}

int32_t
rad_sources_targets(const struct rad_sources *s)
{
    return s->n + s->nvirtuals;
}

void
rad_source_in_plane(struct rad_ctx *ctx, struct rad_ray *r)
{
    int32_t target = rad_source_target(ctx->job->sources, r->source);
    struct rad_span span = { .tmin = 0, .tmax = r->tmax };
    struct rad_hit hit;
    double both;

    if (r->hit.obj == target ||
        rad_source_distant(ctx->job->sources, r->source))
        return;
    rad_copy(span.org, r->org);
    rad_copy(span.dir, r->dir);
    if (!rad_geom_hit_object(ctx->job->geom, target, &span, &hit,
                             &ctx->counts.geom))
        return;
    /* either may be off by its bound, as in rad_way_aim() */
    both = 2 * (hit.err + r->hit.err);
    if ((hit.t - r->hit.t) * fabs(rad_dot(hit.n, r->dir)) <= both)
        r->hit = hit;
}

/* Bound of the rounding error in the difference of two unit vectors. */
#define ROUNDING (4 * DBL_EPSILON)

/* Does direction dir meet distant source src?  By the length of the chord from
 * the source's centre to dir: 1 - cos would lose all digits where a source is
 * small.  A ray aimed at the source's edge must meet it whatever its rounding
 * errors are, and a horizontal ray must meet the sky. */
static bool
meets(const struct rad_source *src, const double dir[3])
{
    double edge = src->radius + ROUNDING, off[3];

    rad_sub(off, dir, src->centre);
    return rad_dot(off, off) <= edge * edge;
}

/* The number of the distant source that r meets, or -1.  A light hides a glow
 * (the sky behind the sun), and an illum without alternate, which rays pass;
 * ambient and glossy rays do not see the glow behind such an illum, since the
 * illum stands for it. */
static int32_t
find_behind(const struct rad_sources *s, const struct rad_ray *r)
{
    int32_t glow = -1;
    bool window = false;

    if (r->source >= 0) {
        const struct rad_source *src = &s->list[r->source];

        if (r->source >= s->n) /* aimed at an image, and missed its mirror */
            return -1;
        return src->flags & RAD_LIGHT_DISTANT && meets(src, r->dir) ? r->source
                                                                    : -1;
    }
    for (int32_t k = 0; k < s->ndistant; k++) {
        const struct rad_source *src = &s->list[s->distant[k]];

        if (!meets(src, r->dir))
            continue;
        if (src->flags & RAD_LIGHT_PASSES)
            window = true;
        else if (!(src->flags & RAD_LIGHT_SKIP))
            return s->distant[k];
        else if (glow < 0)
            glow = s->distant[k];
    }
    if (window && r->path & (RAD_RAY_AMBIENT | RAD_RAY_SPECULAR))
        return -1;
    return glow;
}

int32_t
rad_source_behind(struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_job *job = ctx->job;
    int32_t i = find_behind(job->sources, r);

    if (i < 0)
        return RAD_VOID;
    r->far_source = i;
    r->hit.t = INFINITY;
    rad_copy(r->hit.p, r->org); /* no place: patterns get the ray's origin */
    rad_scale(r->n, -1, r->dir);
    r->cos_o = 1;
    r->pert[0] = r->pert[1] = r->pert[2] = 0;
    r->pattern = rad_grey(1);
    r->dist = INFINITY;
    return job->scene->objects[job->sources->list[i].obj].modifier;
}

void
rad_source_shape(const struct rad_sources *s, int32_t i,
                 struct rad_source_shape *shape)
{
    const struct rad_source *src = rad_source_root(s, i);

    shape->obj = src->obj;
    shape->distant = src->flags & RAD_LIGHT_DISTANT;
    shape->flat = src->flags & RAD_LIGHT_FLAT;
    rad_copy(shape->centre, src->centre);
    for (int k = 0; k < 3; k++)
        rad_copy(shape->axis[k], src->axis[k]);
    shape->radius = src->radius;
}
