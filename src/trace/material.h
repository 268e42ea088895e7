/* material.h - what the modifiers of a scene do to a ray
 *
 * Every modifier type has one row in the table of shade/families.c: how to
 * compile its arguments once, and what it does to a ray.  A family of modifiers
 * lives in a file of its own: materials in shade/, those that reflect gloss in
 * shade/gloss/, light sources in light/direct/emitter.c, patterns, textures and
 * mixtures in pattern/.
 * A shader returns true when it was a material and has set r->L; a texture or
 * pattern changes r->pert or r->pattern and returns false.
 * Thread: materials are compiled by one, and read by all from then on. */
#ifndef RAD_TRACE_MATERIAL_H
#define RAD_TRACE_MATERIAL_H

#include "trace/ray.h"

struct rad_material {
    const struct rad_shader *shader; /* NULL for surfaces, and where a ray
                                      * need not stop (alias to inherit) */
    const void *data;                /* compiled arguments, in job->arena */
    int32_t next;                    /* modifier behind this one, RAD_VOID */
    unsigned flags; /* RAD_MAT_*, the type's but where they depend on its
                     * arguments */
};

/* what a material is to others */
enum {
    RAD_MAT_TRANSPARENT = 1, /* loses ties, and -i sees through it (glass,
                              * dielectric, trans, ...) */
    RAD_MAT_OPAQUE = 2,      /* no shadow ray passes, on either side */
    RAD_MAT_EMITS = 4,       /* light, illum, glow, spotlight */
    RAD_MAT_PATTERN = 8,     /* no material: only changes pattern and pert */
    RAD_MAT_CUTS = 16,       /* antimatter: no surface, even to -i */
    RAD_MAT_MIXTURE = 32,    /* a material if it mixes any, else a pattern */
    RAD_MAT_PASSED = 64      /* most light that meets it goes straight on */
};

struct rad_shader {
    enum rad_otype type;
    unsigned flags; /* RAD_MAT_* */
    /* Compile object `index` of the scene; *data may stay NULL. */
    int (*prepare)(struct rad_job *job, int32_t index,
                   const struct rad_files *files, const void **data,
                   struct rad_error *err);
    bool (*shade)(struct rad_ctx *ctx, const struct rad_material *mat,
                  struct rad_ray *r);
};

/* Does object index have between least and most real arguments?  What
 * rad_scene_check() has passed has. */
int rad_material_reals(const struct rad_job *job, int32_t index, int least,
                       int most, struct rad_error *err);

/* The same, and zeroed room for what its shader makes of it: NULL, and why in
 * *code. */
void *rad_material_begin(struct rad_job *job, int32_t index, int least,
                         int most, size_t size, int *code,
                         struct rad_error *err);

/* The bytes of a file that object o names, malloc'd; what fails names o. */
int rad_material_file(const struct rad_job *job, const struct rad_object *o,
                      const struct rad_files *files, const char *name,
                      char **data, size_t *len, struct rad_error *err);

/* Something is wrong in a file: the scene's place comes first, then *why,
 * which names the file or gets its name. */
int rad_material_file_fail(const struct rad_job *job,
                           const struct rad_object *o, const char *name,
                           const struct rad_error *why, struct rad_error *err);

/* Compile the modifiers that surfaces lead to into job->materials. */
int rad_materials_compile(struct rad_job *job, const struct rad_files *files,
                          struct rad_error *err);

/* The first of the chain from modifier mod that does something; NULL: there is
 * none. */
static inline const struct rad_material *
rad_material_first(const struct rad_job *job, int32_t mod)
{
    while (mod != RAD_VOID && !job->materials[mod].shader)
        mod = job->materials[mod].next;
    return mod == RAD_VOID ? NULL : &job->materials[mod];
}

/* Is surface material m a light source's?  Is object i a surface of such? */
bool rad_material_lights(const struct rad_object *m);
bool rad_surface_lights(const struct rad_scene *scene, int32_t i);

/* The material that ends the chain from modifier mod (an alias is replaced by
 * what it stands for), as an object's index, or RAD_VOID. */
int32_t rad_material_of(const struct rad_scene *scene, int32_t mod);

#endif
