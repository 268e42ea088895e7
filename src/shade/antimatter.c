/* antimatter.c - see antimatter.h
 *
 * A ray has no list of modifiers that are cut away where it is: its ancestors
 * tell.  A modifier is cut away if the path went into the last antimatter that
 * it passed and that names the modifier.  A ray that is reflected from a
 * surface stays on the side from which it came.  Only rays that meet a surface
 * whose modifier some antimatter names look up their path.
 *
 * A name stands for the first of equal definitions (scene.h), but a surface
 * from a frozen octree refers to its modifier by place.  If two files define
 * the same material and the same antimatter, the antimatter of each must cut
 * the surfaces of both.  So modifiers are compared by the first of equal
 * definitions. */
#include "config.h"

#include "shade/antimatter.h"

#include <string.h>

struct antimatter {
    int32_t index;   /* of its object */
    bool filled;     /* the first name is not "void" */
    int32_t filling; /* the modifier that cuts show then */
    int32_t n;       /* number of modifiers that are named */
    int32_t names[]; /* these, each the first of equal definitions */
};

/* Does the antimatter name the modifier? */
static bool
has(const struct rad_job *job, const struct antimatter *a, int32_t modifier)
{
    if (modifier == RAD_VOID)
        return false;
    for (int32_t i = 0; i < a->n; i++)
        if (a->names[i] == job->first_like[modifier])
            return true;
    return false;
}

/* Make job->cut and job->first_like, unless they are made.  False: out of
 * memory. */
static bool
begin(struct rad_job *job)
{
    const struct rad_scene *scene = job->scene;
    size_t n = (size_t)scene->nobjects;

    if (job->cut)
        return true;
    job->first_like = rad_arena_calloc(&job->arena, n, sizeof *job->first_like);
    job->cut = rad_arena_calloc(&job->arena, n, sizeof *job->cut);
    if (!job->first_like || !job->cut)
        return false;
    for (int32_t i = 0; i < scene->nobjects; i++) {
        const struct rad_object *o = &scene->objects[i];

        if (!rad_otype_is_surface(o->type))
            job->first_like[i] = rad_scene_find_modifier(scene, o->name, i + 1);
    }
    return true;
}

/* Note in job->cut that surfaces of modifier m, and of equal ones, may be cut.
 */
static void
mark(struct rad_job *job, int32_t m)
{
    if (job->cut[m])
        return;
    for (int32_t i = m; i < job->scene->nobjects; i++)
        if (job->first_like[i] == m &&
            !rad_otype_is_surface(job->scene->objects[i].type))
            job->cut[i] = 1;
}

int
rad_antimatter_prepare(struct rad_job *job, int32_t index,
                       const struct rad_files *files, const void **data,
                       struct rad_error *err)
{
    const struct rad_scene *scene = job->scene;
    const struct rad_object *o = &scene->objects[index];
    struct antimatter *a = rad_arena_calloc(
        &job->arena, 1, sizeof *a + (size_t)o->nstrings * sizeof a->names[0]);

    (void)files;
    if (!a || !begin(job))
        return rad_fail_memory(err);
    if (o->nstrings < 1)
        return rad_scene_fail(scene, o, err, RAD_EDATA,
                              "expected at least 1 string argument");
    for (int32_t i = 0; i < o->nstrings; i++) {
        int32_t m = rad_scene_find_modifier(scene, o->strings[i], index);

        if (m == RAD_VOID) /* as in Radiance, an unknown name is ignored */
            continue;
        mark(job, m);
        a->names[a->n++] = m;
    }
    a->index = index;
    a->filled = strcmp(o->strings[0], "void") != 0;
    a->filling = rad_scene_find_modifier(scene, o->strings[0], index);
    *data = a;
    return 0;
}

/* Does the child go on through the surface that its parent met? */
static bool
goes_through(const struct rad_ray *child)
{
    return !(child->kind & RAD_RAY_REFL);
}

/* Is r inside antimatter that cuts away surfaces of the modifier? */
static bool
is_within(const struct rad_job *job, const struct rad_ray *r, int32_t modifier)
{
    for (; r->parent; r = r->parent) {
        const struct rad_ray *p = r->parent;
        int32_t m = p->passed_cut;

        if (goes_through(r) && m != RAD_VOID &&
            has(job, job->materials[m].data, modifier))
            return p->into_cut;
    }
    return false;
}

bool
rad_antimatter_hides(const struct rad_ctx *ctx, struct rad_ray *r)
{
    const struct rad_job *job = ctx->job;
    int32_t modifier = job->scene->objects[r->hit.obj].modifier;

    if (!is_within(job, r, modifier))
        return false;
    r->kind |= RAD_RAY_CUT;
    return true;
}

/* How many surfaces of the named modifiers has r's path entered, less those
 * that it left? */
static int
depth_inside(const struct rad_ctx *ctx, const struct antimatter *a,
             const struct rad_ray *r)
{
    const struct rad_object *objects = ctx->job->scene->objects;
    int depth = 0;

    for (; r->parent; r = r->parent) {
        const struct rad_ray *p = r->parent;

        if (goes_through(r) && p->hit.obj != RAD_VOID &&
            has(ctx->job, a, objects[p->hit.obj].modifier))
            depth += p->cos_o > 0 ? 1 : -1;
    }
    return depth;
}

bool
rad_antimatter_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r)
{
    const struct antimatter *a = mat->data;

    r->passed_cut = a->index;
    r->into_cut = r->cos_o > 0; /* turned, where another cut shows it */
    if (a->filled && depth_inside(ctx, a, r) > 0) {
        rad_ray_flip(r); /* the cut's front is on the side of the hole */
        return rad_ray_shade(ctx, r, a->filling);
    }
    rad_ray_transmit(ctx, r);
    return true;
}
