/* pointfacts.c - see pointfacts.h
 *
 * A fact is what rtrace prints of a ray that it traces: names and normal are
 * those of the first object, even if light passes straight through it. */
#include "config.h"

#include "points/pointfacts.h"

#include "base/vec.h"
#include "light/direct/sources.h"
#include "trace/asks.h"
#include "trace/material.h"
#include "trace/ray.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct pointfacts {
    struct rad_job *job;
    struct rad_ctx ctx;
};

/* What Radiance writes for an infinite distance. */
#define FAR_AWAY 1e10

struct pointfacts *
pointfacts_new(const struct rad_scene *scene, const struct rad_files *files,
               const struct rad_params *params, struct rad_error *err)
{
    struct pointfacts *p = calloc(1, sizeof *p);
    struct rad_params dark = *params;

    if (!p) {
        rad_fail_memory(err);
        return NULL;
    }
    dark.ambounce = 0;
    p->job = rad_job_new(scene, &dark, files, err);
    if (p->job && rad_ctx_init(&p->ctx, p->job, err) == 0)
        return p;
    rad_job_free(p->job);
    free(p);
    return NULL;
}

void
pointfacts_free(struct pointfacts *p)
{
    if (!p)
        return;
    rad_ctx_release(&p->ctx);
    rad_job_free(p->job);
    free(p);
}

void
pointfacts_none(struct pointfact *f, const double org[3])
{
    memset(f, 0, sizeof *f);
    f->length = FAR_AWAY;
    rad_copy(f->at, org);
    f->surface = f->modifier = f->material = "*";
}

static void
tell_names(const struct rad_scene *s, int32_t obj, struct pointfact *out)
{
    int32_t mod = s->objects[obj].modifier, mat = rad_material_of(s, mod);

    out->surface = s->objects[obj].name;
    out->modifier = mod == RAD_VOID ? "void" : s->objects[mod].name;
    out->material = mat == RAD_VOID ? "void" : s->objects[mat].name;
}

/* Does the chain's material name another that the eye sees in its place, as an
 * illum or mirror may?  *mod is set to that. */
static bool
stands_for_another(const struct rad_scene *s, int32_t *mod)
{
    int32_t mat = rad_material_of(s, *mod);
    const struct rad_object *o = mat == RAD_VOID ? NULL : &s->objects[mat];

    if (!o || o->nstrings == 0 ||
        (o->type != RAD_ILLUM && o->type != RAD_MIRROR))
        return false;
    rad_scene_named(s, mat, 0, mod, NULL);
    return true;
}

/* Apply the textures before the chain's material, past aliases, and those that
 * are mixed: a mixture with a modifier is no material.  Returns the modifier
 * behind the material. */
static int32_t
perturb(struct pointfacts *p, struct rad_ray *r, int32_t mod)
{
    while (mod != RAD_VOID) {
        const struct rad_material *mat = &p->job->materials[mod];
        unsigned flags = mat->shader ? mat->shader->flags : RAD_MAT_PATTERN;

        mod = mat->next;
        if (!(flags & RAD_MAT_PATTERN) &&
            (!(flags & RAD_MAT_MIXTURE) || mod == RAD_VOID))
            break;
        if (mat->shader && mat->shader->shade(&p->ctx, mat, r))
            break;
    }
    return mod;
}

/* Does Radiance shade this material by a normal on the ray's side, whichever
 * side the ray met? */
static bool
turns(const struct rad_scene *s, int32_t mod)
{
    int32_t mat = rad_material_of(s, mod);

    switch (mat == RAD_VOID ? RAD_NOTYPES : s->objects[mat].type) {
    case RAD_PLASTIC:
    case RAD_METAL:
    case RAD_TRANS:
    case RAD_PLASTIC2:
    case RAD_METAL2:
    case RAD_TRANS2:
    case RAD_ASHIK2:
    case RAD_GLASS:
    case RAD_PLASFUNC:
    case RAD_METFUNC:
    case RAD_TRANSFUNC:
    case RAD_PLASDATA:
    case RAD_METDATA:
    case RAD_TRANSDATA:
        return true;
    default:
        return false;
    }
}

void
pointfacts_find(struct pointfacts *p, const double org[3], const double dir[3],
                double reach, struct pointfact *out)
{
    const struct rad_job *job = p->job;
    const struct rad_scene *scene = job->scene;
    struct rad_span span = { .tmin = 0, .tmax = reach };
    struct rad_arena_mark mark = rad_arena_mark(&p->ctx.scratch);
    struct rad_ray r;
    int32_t mod, behind;

    pointfacts_none(out, org);
    memset(&r, 0, sizeof r);
    r.tmax = reach;
    rad_copy(r.org, org);
    rad_copy(r.dir, dir);
    rad_ray_spawn(&p->ctx, &r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    rad_ray_clear(&r);
    rad_copy(span.org, org);
    rad_copy(span.dir, dir);
    if (rad_geom_nearest(job->geom, &span, &r.hit, &p->ctx.counts.geom)) {
        rad_ray_enter(&r);
        out->length = r.hit.t;
        rad_copy(out->at, r.hit.p);
        rad_copy(out->normal, r.n);
        mod = scene->objects[r.hit.obj].modifier;
        do
            behind = perturb(p, &r, mod);
        while (stands_for_another(scene, &mod));
        rad_ray_texture(&p->ctx, &r, behind);
        if (r.cos_o < 0 && turns(scene, mod))
            rad_ray_flip(&r);
        rad_ray_normal(&r, out->perturbed);
        tell_names(scene, r.hit.obj, out);
    } else if (reach < INFINITY) {
        rad_madd(out->at, org, reach, dir);
    } else if (rad_source_behind(&p->ctx, &r) != RAD_VOID) {
        rad_copy(out->normal, r.n);
        rad_copy(out->perturbed, r.n);
        tell_names(scene, job->sources->list[r.far_source].obj, out);
    }
    rad_arena_rewind(&p->ctx.scratch, mark);
}
