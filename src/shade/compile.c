/* compile.c - rad_job_new() and the like; see trace/job.h */
#include "config.h"

#include "light/direct/source.h"
#include "light/direct/virtual.h"
#include "light/indirect/ambient.h"
#include "scene/calc/calc.h"
#include "shade/mist.h"
#include "trace/material.h"

#include <stdlib.h>
#include <string.h>

/* The properties of surface i's material that intersection needs:
 * RAD_SURF_*. */
static uint8_t
surface_flags(const struct rad_job *job, int32_t i)
{
    const struct rad_scene *scene = job->scene;
    int32_t mod = scene->objects[i].modifier;
    int32_t m = rad_material_of(scene, mod);
    unsigned flags, onesided = 0;

    if (m == RAD_VOID)
        return RAD_SURF_NOMATERIAL | RAD_SURF_PASSED;
    flags = job->materials[m].flags;
    if (scene->objects[m].type == RAD_MIRROR && scene->objects[m].nstrings > 0)
        flags &= ~(unsigned)RAD_MAT_OPAQUE; /* rays see its alternate */
    if (job->cut && job->cut[mod])
        flags &= ~(unsigned)RAD_MAT_OPAQUE; /* it may be cut away */
    if (!job->params.backvis && flags & RAD_MAT_OPAQUE &&
        !(flags & RAD_MAT_EMITS))
        onesided = RAD_SURF_ONESIDED;
    return (uint8_t)((flags & RAD_MAT_OPAQUE ? RAD_SURF_OPAQUE : 0) |
                     (flags & RAD_MAT_TRANSPARENT ? RAD_SURF_TRANSPARENT : 0) |
                     (flags & RAD_MAT_PASSED ? RAD_SURF_PASSED : 0) |
                     (flags & RAD_MAT_EMITS ? RAD_SURF_LAMP : 0) | onesided);
}

static int
compile_geometry(struct rad_job *job, struct rad_error *err)
{
    int32_t n = job->scene->nobjects;
    uint8_t *surf = calloc(n > 0 ? (size_t)n : 1, sizeof *surf);

    if (!surf)
        return rad_fail_memory(err);
    for (int32_t i = 0; i < n; i++) {
        enum rad_otype type = job->scene->objects[i].type;

        if (rad_otype_is_surface(type))
            surf[i] = surface_flags(job, i);
    }
    job->geom = rad_geom_new(job->scene, surf, 0, err);
    free(surf);
    return job->geom ? 0 : RAD_EDATA;
}

/* Is the name in a list of words with blanks between them? */
static bool
is_listed(const char *list, const char *name)
{
    size_t n = strlen(name);

    for (const char *at = list; n > 0 && (at = strstr(at, name)) != NULL;
         at += n)
        if ((at == list || at[-1] == ' ') && (at[n] == ' ' || at[n] == '\0'))
            return true;
    return false;
}

/* Set job->noambient by -ae or -ai: surfaces of these modifiers get the ambient
 * value alone.  As in Radiance a name means all modifiers that have it, and a
 * name that no modifier has is ignored. */
static int
compile_ambient_list(struct rad_job *job, struct rad_error *err)
{
    const struct rad_scene *scene = job->scene;
    bool include = job->params.amblisted == RAD_AMB_INCLUDE;

    if (job->params.amblisted == RAD_AMB_ALL || job->params.ambounce <= 0)
        return 0;
    job->noambient = rad_arena_calloc(&job->arena, (size_t)scene->nobjects + 1,
                                      sizeof *job->noambient);
    if (!job->noambient)
        return rad_fail_memory(err);
    for (int32_t i = 0; i < scene->nobjects; i++)
        job->noambient[i] =
            is_listed(job->params.amblist, scene->objects[i].name) != include;
    return 0;
}

/* Set job->primary, and job->params with its colours in the job's channels. */
static void
set_channels(struct rad_job *job, const struct rad_params *params)
{
    const struct rad_bands *b = &params->bands;
    struct rad_rgb *const colours[] = { &job->params.ambval,
                                        &job->params.cextinction,
                                        &job->params.salbedo };

    job->params = *params;
    for (int k = 0; k < 3; k++)
        job->primary[k] =
            b->plane == RAD_PLANE_COLOURS
                ? (uint8_t)k
                : (uint8_t)rad_bands_primary(b, rad_bands_of(b, b->plane, k));
    for (int i = 0; i < 3; i++) {
        struct rad_rgb c = *colours[i];

        *colours[i] = rad_job_colour(
            job, (double[]){ (double)c.r, (double)c.g, (double)c.b });
    }
}

/* Has the plane all of the scene's bands? */
static int
check_plane(const struct rad_job *job, struct rad_error *err)
{
    if (job->params.bands.plane != RAD_PLANE_COLOURS ||
        !rad_scene_spectrum(job->scene))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "option '--plane %d': the scene has spectra",
                    RAD_PLANE_COLOURS);
}

static int
compile(struct rad_job *job, const struct rad_files *files,
        struct rad_error *err)
{
    const struct rad_params *p = &job->params;
    int code = check_plane(job, err);

    if (code < 0 || (code = rad_materials_compile(job, files, err)) < 0 ||
        (code = compile_geometry(job, err)) < 0)
        return code;
    job->sources = rad_sources_new(job, err);
    if (!job->sources)
        return RAD_EDATA;
    code = rad_virtuals_make(job, err);
    if (code < 0 || (code = rad_mists_resolve(job, err)) < 0)
        return code;
    if ((code = compile_ambient_list(job, err)) < 0)
        return code;
    if (p->ambounce > 0 && p->ambacc > 0) {
        job->ambient = rad_ambient_new(job, err);
        if (!job->ambient)
            return RAD_ENOMEM;
    }
    return 0;
}

struct rad_job *
rad_job_new(const struct rad_scene *scene, const struct rad_params *params,
            const struct rad_files *files, struct rad_error *err)
{
    struct rad_job *job = calloc(1, sizeof *job);

    if (!job) {
        rad_fail_memory(err);
        return NULL;
    }
    job->scene = scene;
    set_channels(job, params);
    rad_arena_init(&job->arena);
    if (compile(job, files, err) < 0) {
        rad_job_free(job);
        return NULL;
    }
    return job;
}

int
rad_job_check(const struct rad_scene *scene, const struct rad_files *files,
              struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct rad_job *job = calloc(1, sizeof *job);
    struct rad_params usual;
    int code;

    if (!job)
        return rad_fail_memory(err);
    job->scene = scene;
    job->unseen = true;
    rad_params_init(&usual);
    set_channels(job, &usual);
    rad_arena_init(&job->arena);
    code = rad_materials_compile(job, files, &why);
    if (code < 0 && why.code < 0)
        code = why.code; /* more exact: RAD_ENOINPUT if a file is missing */
    if (code < 0 && err)
        *err = why;
    rad_job_free(job);
    return code < 0 ? code : 0;
}

void
rad_job_free(struct rad_job *job)
{
    if (!job)
        return;
    rad_ambient_free(job->ambient);
    rad_geom_free(job->geom);
    rad_calc_free(job->calc);
    rad_arena_release(&job->arena);
    free(job);
}

void
rad_job_show(struct rad_job *job, int samples)
{
    job->params.samples = samples;
}
