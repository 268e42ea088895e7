/* emitter.h - the materials that give light: light, illum, glow, spotlight
 *
 * The parameters of which sources are made, and the shader for rays that meet
 * an emitter.
 * Source: Radiance's reference manual, "light" to "spotlight". */
#ifndef RAD_LIGHT_EMITTER_H
#define RAD_LIGHT_EMITTER_H

#include "light/sample/spot.h"
#include "trace/material.h"

struct rad_emitter {
    enum rad_otype type;
    struct rad_rgb L;     /* radiance before patterns [W/sr/m^2] */
    double radius;        /* glow: surfaces nearer than this get direct light;
                           * 0: none do, but rays of hemispheres and gloss may
                           * meet the glow; negative: the glow lights nothing.
                           * INFINITY for the other types */
    struct rad_spot spot; /* spotlight */
    int32_t alternate;    /* illum: modifier that other rays see, or RAD_VOID */
};

/* The emitter that is the material of obj; NULL: obj has another material, or
 * none, or is no surface. */
const struct rad_emitter *rad_emitter_of(const struct rad_job *job,
                                         int32_t obj);

/* Of the table of materials (trace/material.h): compile the material, and shade
 * a ray that meets it. */
int rad_emitter_prepare(struct rad_job *job, int32_t index,
                        const struct rad_files *files, const void **data,
                        struct rad_error *err);
bool rad_emitter_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                       struct rad_ray *r);

#endif
