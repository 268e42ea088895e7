/* material.h - the modifiers of a scene, compiled
 *
 * Every modifier type has one row in the table of shade/families.c: a function
 * that compiles its arguments, and a shader, which applies it to a ray.  A
 * family of modifiers lives in a file of its own: materials in shade/, those
 * that reflect gloss in shade/gloss/, light sources in light/direct/emitter.c,
 * patterns, textures and mixtures in pattern/.
 * The shader of a material sets r->L and returns true; that of a texture or
 * pattern changes r->pert or r->pattern and returns false.
 * Thread: one thread compiles materials, all threads read them from then on. */
#ifndef RAD_TRACE_MATERIAL_H
#define RAD_TRACE_MATERIAL_H

#include "trace/ray.h"

struct rad_material {
    const struct rad_shader *shader; /* NULL: a surface, or a modifier that does
                                      * nothing (an alias that inherits, a
                                      * texture on a lamp) */
    const void *data;                /* compiled arguments, in job->arena */
    int32_t next;                    /* modifier behind this one, RAD_VOID */
    unsigned flags; /* RAD_MAT_*: the shader's, unless they depend on the
                     * arguments */
};

/* Properties of a material that other code asks for. */
enum {
    RAD_MAT_TRANSPARENT = 1, /* glass, dielectric, trans...: loses ties of hits,
                              * and -i sees through it */
    RAD_MAT_OPAQUE = 2,      /* no shadow ray passes, on either side */
    RAD_MAT_EMITS = 4,       /* light, illum, glow, spotlight */
    RAD_MAT_PATTERN = 8,     /* pattern or texture: only changes r->pattern or
                              * r->pert */
    RAD_MAT_CUTS = 16,       /* antimatter: no surface, even to -i */
    RAD_MAT_MIXTURE = 32,    /* a material if it mixes materials, else a
                              * pattern */
    RAD_MAT_PASSED = 64      /* most light that meets it goes straight on */
};

struct rad_shader {
    enum rad_otype type;
    unsigned flags; /* RAD_MAT_* */
    /* Compile object `index` of the scene into *data, which may stay NULL.  0
     * or a negative code. */
    int (*prepare)(struct rad_job *job, int32_t index,
                   const struct rad_files *files, const void **data,
                   struct rad_error *err);
    /* Apply it to r's hit; see above. */
    bool (*shade)(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r);
};

/* 0 if object `index` has `least` to `most` real arguments, else RAD_EDATA.
 * (Always 0 for a scene that has passed rad_scene_check().) */
int rad_material_reals(const struct rad_job *job, int32_t index, int least,
                       int most, struct rad_error *err);

/* The same, and `size` zeroed bytes in job->arena for the compiled arguments.
 * NULL: *code is what failed. */
void *rad_material_begin(struct rad_job *job, int32_t index, int least,
                         int most, size_t size, int *code,
                         struct rad_error *err);

/* Read a file that object o names; *data is malloc'd.  0, or a code and *err,
 * which names o. */
int rad_material_file(const struct rad_job *job, const struct rad_object *o,
                      const struct rad_files *files, const char *name,
                      char **data, size_t *len, struct rad_error *err);

/* Fail with why->code, since something is wrong in a file that object o names.
 * The message begins with o's place in the scene; then comes *why, with the
 * file's name before it unless it has that. */
int rad_material_file_fail(const struct rad_job *job,
                           const struct rad_object *o, const char *name,
                           const struct rad_error *why, struct rad_error *err);

/* Compile the modifiers that surfaces lead to into job->materials. */
int rad_materials_compile(struct rad_job *job, const struct rad_files *files,
                          struct rad_error *err);

/* The first modifier with a shader in the chain that begins with mod; NULL:
 * there is none. */
static inline const struct rad_material *
rad_material_first(const struct rad_job *job, int32_t mod)
{
    while (mod != RAD_VOID && !job->materials[mod].shader)
        mod = job->materials[mod].next;
    return mod == RAD_VOID ? NULL : &job->materials[mod];
}

/* Does material m make its surfaces light sources? */
bool rad_material_lights(const struct rad_object *m);
/* Is object i a surface, and a light source by its material? */
bool rad_surface_lights(const struct rad_scene *scene, int32_t i);

/* The index of the material that ends the chain from modifier mod, or RAD_VOID;
 * an alias is replaced by the modifier that it stands for. */
int32_t rad_material_of(const struct rad_scene *scene, int32_t mod);

#endif
