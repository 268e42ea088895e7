/* ray.h - one ray: where it goes, what it met, what it brought back
 *
 * A ray is made by rad_ray_spawn(), traced by rad_ray_trace(), and shaded by
 * the material that its surface's modifier chain ends in, which may spawn
 * more.  A ray cannot fail: it misses, and brings back black.
 * L is radiance [W/sr/m^2] toward the ray's origin.
 * Source: Ward 1994, The RADIANCE lighting simulation and rendering system;
 * what each ray kind means: Radiance's ray types. */
#ifndef RAD_SHADE_RAY_H
#define RAD_SHADE_RAY_H

#include "base/color.h"
#include "geom/geom.h"
#include "shade/job.h"

#include <stdbool.h>
#include <stdint.h>

enum rad_raykind {
    RAD_RAY_PRIMARY = 01,
    RAD_RAY_RSHADOW = 02,    /* to a light source, off the near side */
    RAD_RAY_REFLECTED = 04,  /* mirror reflection */
    RAD_RAY_REFRACTED = 010,
    RAD_RAY_TRANS = 020,     /* passed on unbent */
    RAD_RAY_RAMBIENT = 040,  /* indirect diffuse, near side */
    RAD_RAY_RSPECULAR = 0100, /* sampled gloss */
    RAD_RAY_TSHADOW = 0200,  /* to a light source through the surface */
    RAD_RAY_TAMBIENT = 0400,
    RAD_RAY_TSPECULAR = 01000
};
#define RAD_RAY_SHADOW (RAD_RAY_RSHADOW | RAD_RAY_TSHADOW)
#define RAD_RAY_AMBIENT (RAD_RAY_RAMBIENT | RAD_RAY_TAMBIENT)
#define RAD_RAY_SPECULAR (RAD_RAY_RSPECULAR | RAD_RAY_TSPECULAR)
/* kinds that count as a reflection for -lr */
#define RAD_RAY_REFL                                                          \
    (RAD_RAY_RSHADOW | RAD_RAY_REFLECTED | RAD_RAY_RAMBIENT |                 \
     RAD_RAY_RSPECULAR)

struct rad_ray {
    /* set by the spawner */
    double org[3], dir[3]; /* dir of unit length */
    double tmax;           /* aft clipping distance, INFINITY: none */
    const struct rad_ray *parent;
    uint64_t key;          /* of its random numbers: rng.h */
    struct rad_rgb coef;   /* contribution to the parent's L */
    float weight;          /* product of coefs along the path, for -lw */
    int16_t level;         /* reflections so far */
    uint16_t kind;         /* RAD_RAY_* of this ray */
    uint16_t path;         /* kinds of it and all its ancestors */
    int32_t source;        /* shadow ray: index of the source aimed at; else
                            * -1 */
    /* what it met */
    struct rad_hit hit;    /* hit.obj is RAD_VOID: nothing (or a distant
                            * source: then far_source says which) */
    int32_t far_source;    /* index of the distant source met, or -1 */
    double n[3];           /* hit.n, turned by rad_ray_flip() for back sides */
    double cos_o;          /* -dir.n: positive on the side of the normal */
    double pert[3];        /* perturbation of n by textures */
    struct rad_rgb pattern; /* product of the patterns */
    /* what it brings back */
    struct rad_rgb L;
    struct rad_rgb L_mirror; /* part of L that came by mirror reflection */
    double dist;           /* effective length, unmirrored (-z) */
    double mirror_dist;    /* effective length of the mirrored part */
};

/* Start *r off parent (NULL: a primary ray; then set org, dir, tmax, key
 * yourself first).  The caller sets r->dir before tracing; org, level, weight,
 * source and key follow from parent, kind, coef (NULL: unattenuated) and
 * `branch`, a number that no other child of this parent has.  False: too weak
 * or too deep (-lw, -lr; Russian roulette with -lr <= 0): do not trace it. */
bool rad_ray_spawn(struct rad_ctx *ctx, struct rad_ray *r,
                   enum rad_raykind kind, const struct rad_ray *parent,
                   const struct rad_rgb *coef, uint32_t branch);

/* Find what r meets and its radiance.  Counts one ray. */
void rad_ray_trace(struct rad_ctx *ctx, struct rad_ray *r);

/* Fill the shading fields (n, cos_o, pert, pattern, dist) from r->hit. */
void rad_ray_enter(struct rad_ray *r);

/* Shade the hit with the modifier chain that starts at object mod; false: no
 * material there. */
bool rad_ray_shade(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Pass the ray on as if the surface were not there. */
void rad_ray_transmit(struct rad_ctx *ctx, struct rad_ray *r);

/* Apply the textures and patterns of the chain from mod. */
void rad_ray_texture(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* The perturbed unit normal; returns -dir.norm, whose sign is cos_o's. */
double rad_ray_normal(const struct rad_ray *r, double norm[3]);

/* Turn n, cos_o and pert to the other side. */
void rad_ray_flip(struct rad_ray *r);

/* What rpict -z writes: the effective distance of the brighter part. */
double rad_ray_distance(const struct rad_ray *r);

#endif
