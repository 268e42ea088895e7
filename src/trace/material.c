/* material.c - modifiers and their compilation; their table is shade/families.c
 *
 * The entry of an alias is a copy of the modifier that it stands for, with the
 * alias's own modifier behind it.  Modifiers that no surface leads to are not
 * compiled: they may be of any type, and their files need not exist. */
#include "config.h"

#include "trace/asks.h"

#include <stdlib.h>
#include <string.h>

/* A mixture without a modifier counts as a material: it may mix materials. */
static bool
is_material(const struct rad_object *o)
{
    enum rad_oclass class = rad_otype_class(o->type);

    return class == RAD_CLASS_MATERIAL ||
           (class == RAD_CLASS_MIXTURE && o->modifier == RAD_VOID);
}

int32_t
rad_material_of(const struct rad_scene *scene, int32_t mod)
{
    while (mod != RAD_VOID) {
        const struct rad_object *o = &scene->objects[mod];
        int32_t target;
        bool own;

        if (is_material(o))
            return mod;
        target = rad_scene_alias(scene, mod, &own);
        if (own && target != RAD_VOID && is_material(&scene->objects[target]))
            return target;
        mod = o->modifier;
    }
    return RAD_VOID;
}

bool
rad_material_lights(const struct rad_object *m)
{
    switch (m->type) {
    case RAD_LIGHT:
    case RAD_ILLUM:
    case RAD_SPOTLIGHT:
        return true;
    case RAD_GLOW:
        return m->nreals == 4 && m->reals[3] > 0;
    default:
        return false;
    }
}

bool
rad_surface_lights(const struct rad_scene *scene, int32_t i)
{
    const struct rad_object *o = &scene->objects[i];
    int32_t m = rad_otype_is_surface(o->type)
                    ? rad_material_of(scene, o->modifier)
                    : RAD_VOID;

    return m != RAD_VOID && rad_material_lights(&scene->objects[m]);
}

static int
compile_alias(struct rad_job *job, int32_t index, struct rad_error *err)
{
    const struct rad_scene *scene = job->scene;
    const struct rad_object *o = &scene->objects[index];
    bool own;
    int32_t target = rad_scene_alias(scene, index, &own);

    if (!own)
        return 0; /* shader stays NULL: rays go on to the modifier */
    if (target == RAD_VOID)
        return rad_scene_fail(scene, o, err, RAD_EDATA,
                              "undefined modifier '%s'", o->strings[0]);
    job->materials[index].shader = job->materials[target].shader;
    job->materials[index].data = job->materials[target].data;
    job->materials[index].flags = job->materials[target].flags;
    return 0;
}

/* TRANSPARENT if one of n strings, from `first` on, is not "0"; else OPAQUE. */
static unsigned
flags_by_strings(const struct rad_object *o, int first, int n)
{
    for (int i = first; i < first + n && i < o->nstrings; i++)
        if (strcmp(o->strings[i], "0") != 0)
            return RAD_MAT_TRANSPARENT;
    return RAD_MAT_OPAQUE;
}

/* The material's flags: the type's, unless they depend on its arguments. */
static unsigned
flags_of(const struct rad_job *job, const struct rad_object *o,
         const struct rad_shader *shader)
{
    unsigned flags;

    switch (o->type) {
    case RAD_BRTDFUNC: /* its specular transmittances */
        return flags_by_strings(o, 3, 3);
    case RAD_WGMDFUNC: /* its specular transmittance; with -bv- not opaque */
        flags = flags_by_strings(o, 5, 1);
        return job->params.backvis ? flags : flags & ~(unsigned)RAD_MAT_OPAQUE;
    case RAD_BSDF: /* its thickness: rays see the geometry behind it */
        return flags_by_strings(o, 0, 1) & RAD_MAT_TRANSPARENT;
    default:
        return shader->flags;
    }
}

static int
compile_modifier(struct rad_job *job, int32_t index,
                 const struct rad_files *files, struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    struct rad_material *mat = &job->materials[index];

    mat->next = o->modifier;
    if (o->type == RAD_ALIAS)
        return compile_alias(job, index, err);
    mat->shader = rad_families_shader(o->type);
    if (!mat->shader)
        return rad_scene_fail(job->scene, o, err, RAD_EUNSUPPORTED,
                              "not supported");
    mat->flags = flags_of(job, o, mat->shader);
    return mat->shader->prepare(job, index, files, &mat->data, err);
}

/* Is it a texture that nothing shows?  The light of lamps does not depend on
 * the normal, only the other material of an illum may.  Models with smoothed
 * lamps have such textures on every lamp, and each shadow ray would meet one.
 */
static bool
is_idle(const struct rad_job *job, const struct rad_material *m)
{
    if (!m->shader ||
        (m->shader->type != RAD_TEXFUNC && m->shader->type != RAD_TEXDATA))
        return false;
    do
        m = rad_material_first(job, m->next);
    while (m && m->shader->flags & RAD_MAT_PATTERN);
    return m && m->shader->flags & RAD_MAT_EMITS &&
           m->shader->type != RAD_ILLUM;
}

int
rad_material_reals(const struct rad_job *job, int32_t index, int least,
                   int most, struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];

    if (o->nreals < least || o->nreals > most)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "expected %d real arguments, got %d",
                              o->nreals < least ? least : most, o->nreals);
    return 0;
}

void *
rad_material_begin(struct rad_job *job, int32_t index, int least, int most,
                   size_t size, int *code, struct rad_error *err)
{
    void *room;

    *code = rad_material_reals(job, index, least, most, err);
    if (*code < 0)
        return NULL;
    room = rad_arena_calloc(&job->arena, 1, size);
    if (!room)
        *code = rad_fail_memory(err);
    return room;
}

int
rad_material_file_fail(const struct rad_job *job, const struct rad_object *o,
                       const char *name, const struct rad_error *why,
                       struct rad_error *err)
{
    char text[512];

    rad_error_format(why, text, sizeof text);
    if (strstr(text, name))
        return rad_scene_fail(job->scene, o, err, why->code, "%s", text);
    return rad_scene_fail(job->scene, o, err, why->code, "'%s': %s", name,
                          text);
}

int
rad_material_file(const struct rad_job *job, const struct rad_object *o,
                  const struct rad_files *files, const char *name, char **data,
                  size_t *len, struct rad_error *err)
{
    struct rad_error why = { 0 };

    *data = NULL;
    if (files)
        *data = (char *)files->read(files->arg, name, len, &why);
    if (*data)
        return 0;
    rad_fail(&why, RAD_ENOINPUT, "no file '%s'", name);
    return rad_material_file_fail(job, o, name, &why, err);
}

int
rad_materials_compile(struct rad_job *job, const struct rad_files *files,
                      struct rad_error *err)
{
    const struct rad_scene *scene = job->scene;
    int32_t n = scene->nobjects;
    uint8_t *reached;
    int code = 0;

    reached = calloc((size_t)n + 1, sizeof *reached);
    while (n > 0 && rad_otype_is_surface(scene->objects[n - 1].type))
        n--;
    job->materials =
        rad_arena_calloc(&job->arena, (size_t)n, sizeof *job->materials);
    if (!reached || !job->materials) {
        free(reached);
        return rad_fail_memory(err);
    }
    rad_scene_reach(scene, reached);
    for (int32_t i = 0; i < n && code == 0; i++)
        if (reached[i] && !rad_otype_is_surface(scene->objects[i].type))
            code = compile_modifier(job, i, files, err);
    /* not before aliases, which stand for the texture on other materials */
    for (int32_t i = 0; i < n && code == 0; i++)
        if (is_idle(job, &job->materials[i]))
            job->materials[i].shader = NULL;
    free(reached);
    return code;
}
