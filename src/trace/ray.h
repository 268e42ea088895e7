/* ray.h - one ray: where it goes, what it met, what it brought back
 *
 * A ray is made by rad_ray_spawn(), traced by rad_ray_trace(), and shaded by
 * the material that its surface's modifier chain ends in, which may spawn
 * more.  A ray cannot fail: it misses, and brings back black.
 * L is radiance [W/sr/m^2] toward the ray's origin.
 * Thread: a ray, its parents and its rad_ctx are of one thread; the job is read
 * by all.
 * Source: Ward 1994, The RADIANCE lighting simulation and rendering system. */
#ifndef RAD_TRACE_RAY_H
#define RAD_TRACE_RAY_H

#include "base/color.h"
#include "base/vec.h"
#include "geom/geom.h"
#include "trace/job.h"
#include "trace/kinds.h"

#include <stdbool.h>
#include <stdint.h>

/* No ray has more ancestors than this, whatever -lr and -lw say: it bounds the
 * stack (less than 2 KiB a ray) where surfaces without end lie one behind the
 * other.  What lies deeper is black. */
#define RAD_MAX_DEPTH 1500

struct rad_ray {
    /* set by the spawner */
    double org[3], dir[3]; /* dir of unit length */
    double tmax;           /* aft clipping distance, INFINITY: none */
    const struct rad_ray *parent;
    uint64_t key;        /* of its random numbers: rng.h */
    struct rad_rgb coef; /* contribution to the parent's L */
    float weight;        /* product of coefs along the path, for -lw */
    float sample;        /* weight of the hemisphere's ray that it comes of; 0:
                          * of none */
    int16_t level;       /* reflections so far */
    uint16_t depth;      /* ancestors: see RAD_MAX_DEPTH */
    uint16_t kind;       /* RAD_RAY_* of this ray */
    uint16_t path;       /* kinds of it and all its ancestors */
    int32_t source;      /* shadow ray: index of the source aimed at; else
                          * -1 */
    struct rad_rgb ext;  /* extinction of the medium that it goes through
                          * [1/unit]: inside a dielectric or mist */
    const struct rad_medium *medium; /* that scatters, or once did; NULL: none
                                      * (shade/mist.h) */
    /* where it or its ancestors walked to: what lies straight ahead, the next
     * being number line_at; NULL: not known */
    const struct rad_line *line;
    int line_at;
    /* what it met */
    struct rad_hit hit;     /* hit.obj is RAD_VOID: nothing (or a distant
                             * source: then far_source says which) */
    int32_t far_source;     /* index of the distant source met, or -1 */
    int32_t passed_cut;     /* the antimatter that it has passed through there,
                             * as a mixture's part, too; RAD_VOID: none */
    double n[3];            /* hit.n, turned by rad_ray_flip() for back sides */
    double cos_o;           /* -dir.n: positive on the side of the normal */
    double pert[3];         /* perturbation of n by textures */
    struct rad_rgb pattern; /* product of the patterns */
    /* what it brings back */
    struct rad_rgb L;
    struct rad_rgb L_mirror; /* part of L that came by mirror reflection */
    double dist;             /* effective length, unmirrored (-z) */
    double mirror_dist;      /* effective length of the mirrored part */
};

/* Start *r off parent (NULL: a primary ray; then set org, dir, tmax, key
 * yourself, before or after).  The caller sets r->dir before tracing; key,
 * level, weight, source, tmax, ext and medium follow from parent, kind, coef
 * (NULL: unattenuated; may be &r->coef) and `branch`, a number that no other
 * child of this parent has (RAD_BRANCH_*).  False: too weak or too deep (-lw,
 * -lr), left out by Russian roulette (with -lr <= 0, or as a small part of what
 * a hemisphere's ray branches into), or the parent is infinitely long: do not
 * trace it.  r->coef may have been raised by the roulette: weigh by it. */
bool rad_ray_spawn(struct rad_ctx *ctx, struct rad_ray *r,
                   enum rad_raykind kind, const struct rad_ray *parent,
                   const struct rad_rgb *coef, uint32_t branch);

/* Find what r meets and its radiance.  Counts one ray.  Starts it beyond the
 * parent's surface, on the side that r->dir leaves to.  May be called again
 * after dir and key have been changed. */
void rad_ray_trace(struct rad_ctx *ctx, struct rad_ray *r);

/* r, which rad_ray_spawn() started off parent and which has its direction, goes
 * straight on if that is its parent's: then it may meet what is known to be
 * there. */
void rad_ray_onward(struct rad_ray *r);

/* r, which has met something, becomes the ray that goes straight on from there,
 * as rad_ray_spawn() makes it of r; parent, org, line and what it meets and
 * brings back are left alone.  False: it is too weak or too deep. */
bool rad_ray_go_on(const struct rad_ctx *ctx, struct rad_ray *r);

/* Forget what r met and brought back. */
void rad_ray_clear(struct rad_ray *r);

/* Fill the shading fields (n, cos_o, pert, pattern, dist) from r->hit. */
void rad_ray_enter(struct rad_ray *r);

/* Shade the hit with the modifier chain that starts at object mod; false: no
 * material there. */
bool rad_ray_shade(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Shade the hit of an entered ray with its surface's material, or pass it on
 * where there is none. */
void rad_ray_continue(struct rad_ctx *ctx, struct rad_ray *r);

/* Pass the ray on as if the surface were not there. */
void rad_ray_transmit(struct rad_ctx *ctx, struct rad_ray *r);

/* Let the medium from the origin to the hit dim r->L, and add what it scatters;
 * part of rad_ray_trace(), and the last step of a shadow ray shaded without
 * it. */
void rad_ray_absorb(struct rad_ctx *ctx, struct rad_ray *r);

/* Apply the textures and patterns of the chain from mod. */
void rad_ray_texture(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Fractions of light below this are none, as in Radiance, where they decide
 * which parts of a material are there at all. */
#define RAD_TINY 1e-6

/* Has a texture tilted the normal, by more than RAD_TINY? */
static inline bool
rad_ray_perturbed(const struct rad_ray *r)
{
    return rad_dot(r->pert, r->pert) > RAD_TINY * RAD_TINY;
}

/* The perturbed unit normal; returns -dir.norm, whose sign is cos_o's. */
double rad_ray_normal(const struct rad_ray *r, double norm[3]);

/* Does the tilt of the normal turn what passes through?  Not where it rounds
 * off a faceted surface: by the name of its modifier, "Phong", as Radiance's
 * converters give it. */
bool rad_ray_bends(const struct rad_ctx *ctx, const struct rad_ray *r);

/* Where light goes that passes through: straight on, or turned by what a
 * texture tilts the normal, as long as that is still through the surface.  n
 * must be on the side that the ray comes from. */
void rad_ray_ahead(const struct rad_ctx *ctx, const struct rad_ray *r,
                   double ahead[3]);

/* Turn n, cos_o and pert to the other side. */
void rad_ray_flip(struct rad_ray *r);

/* What a surface with two like sides begins with: patterns and textures from
 * mod on apply, and r is turned to the side that was hit.  False: that is a
 * back which is not there (-bv-), and r was shaded with what lies behind. */
bool rad_ray_face(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Did it meet a flat surface, polygon or ring?  What flat mirrors show looks as
 * far away as the light's way is long. */
bool rad_ray_on_flat(const struct rad_ctx *ctx, const struct rad_ray *r);

/* Does dir point to the side of the hit that the ray does not come from? */
bool rad_ray_through(const struct rad_ray *r, const double dir[3]);

/* What rpict -z writes: the effective distance of the brighter part; 1e10, as
 * there, for what is infinitely far. */
double rad_ray_distance(const struct rad_ray *r);

/* How much farther than its surface a ray looks by way of a child that was
 * traced from there.  As in rpict the light that the child found by mirror
 * reflection is compared with what it brings to its parent, by its coefficient,
 * and not with all that it found: behind a dim surface what is mirrored counts
 * sooner. */
double rad_ray_way_of(const struct rad_ray *child);

/* Trace a child that is mirrored, in its direction of any length, and add its
 * light to its parent's.  clear: what the mirror shows is as far away as it
 * looks; else it is taken to be as far as the mirror itself. */
void rad_ray_mirror(struct rad_ctx *ctx, struct rad_ray *r,
                    struct rad_ray *child, bool clear);

/* The irradiance at a point of the scene, on the side of unit normal n: a
 * white surface there, without one being there.  Fills *r as a primary ray
 * that met it, r->L the irradiance [W/m^2].
 * p is taken as exact to a millionth of its largest coordinate or of the
 * scene's extent, whichever is more: that is what six written digits say. */
void rad_ray_irradiance(struct rad_ctx *ctx, struct rad_ray *r,
                        const double p[3], const double n[3], uint64_t key);

/* The same ray before it has any light. */
void rad_ray_place(struct rad_ctx *ctx, struct rad_ray *r, const double p[3],
                   const double n[3], uint64_t key);

#endif
