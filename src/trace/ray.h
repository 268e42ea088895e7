/* ray.h - one ray: where it goes, what it met, what it brought back
 *
 * rad_ray_spawn() makes a ray, rad_ray_trace() traces it, and the material that
 * ends the modifier chain of the surface it meets shades it, and may spawn more
 * rays.  A ray cannot fail: it misses, and brings back black.
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

/* No ray has more ancestors than this, whatever -lr and -lw say: this bounds
 * the stack (2 KiB a reflection, 3 KiB a bounce of indirect light) in scenes
 * with endless surfaces one behind the other.  Deeper rays are black. */
#define RAD_MAX_DEPTH 1500

/* A pixel's ray, or a hemisphere's, is the root of a tree of the rays that it
 * branches into; a path that is walked to find light beyond -ab (rad_ctx.walk)
 * is all of one tree.  Walks and hemispheres, which are many (of 31 rays at
 * most in rooms of mirrors), have the smaller bound.  From so many rays on,
 * times -ss where that asks for several at a surface, branches play Russian
 * roulette: converters write reflectances above 1, where no -lw ends a tree. */
#define RAD_MAX_TREE 4096
#define RAD_MAX_WALK 256

struct rad_ray {
    /* set by the spawner */
    double org[3], dir[3]; /* dir of unit length */
    double tmax;           /* aft clipping distance, INFINITY: none */
    const struct rad_ray *parent;
    uint64_t key;        /* of its random numbers: rng.h */
    struct rad_rgb coef; /* contribution to the parent's L */
    float weight;        /* product of coefs along the path, for -lw */
    float sample;        /* weight of its nearest ancestor, or itself, that is a
                          * hemisphere's ray; 0: there is none */
    float blur;          /* added to the square roughness of gloss in which it
                          * shows lamps: CELL_ROUGHNESS of hemisphere.c */
    int16_t level;       /* reflections so far */
    uint16_t depth;      /* ancestors: see RAD_MAX_DEPTH */
    uint16_t kind;       /* RAD_RAY_* of this ray */
    uint16_t path;       /* kinds of this ray and of all its ancestors */
    int32_t source;      /* shadow ray: number of the source or image that it is
                          * aimed at; else -1 */
    struct rad_rgb ext;  /* extinction of the medium that it goes through, of a
                          * dielectric or mist [1/unit] */
    const struct rad_medium *medium; /* innermost link of the chain of media
                                      * that it is in (shade/mist.h), or NULL */
    /* the surfaces straight ahead that it or an ancestor has found; number
     * line_at is next; NULL: not known */
    const struct rad_line *line;
    int line_at;
    /* what it met */
    struct rad_hit hit;     /* hit.obj is RAD_VOID: no surface */
    int32_t far_source;     /* number of the distant source met, or -1 */
    int32_t passed_cut;     /* antimatter whose surface it met and passes, also
                             * as a part of a mixture; RAD_VOID: none */
    bool into_cut;          /* it passed that from the front */
    double n[3];            /* hit.n, or its reverse after rad_ray_flip() */
    double cos_o;           /* -dir.n: positive on the side of the normal */
    double pert[3];         /* perturbation of n by textures */
    struct rad_rgb pattern; /* product of the patterns */
    /* what it brings back */
    struct rad_rgb L;
    struct rad_rgb L_mirror; /* part of L that came by mirror reflection */
    double dist;             /* effective length of the unmirrored part (-z) */
    double mirror_dist;      /* effective length of the mirrored part */
};

/* Make *r a child of parent.  key, level, weight, source, tmax, ext and medium
 * follow from the arguments; the caller sets r->dir before it traces r.
 *   parent  NULL: a primary ray, whose org, dir, tmax and key the caller sets,
 *           before or after this call
 *   coef    contribution to the parent's L; NULL: 1; may be &r->coef
 *   branch  a number that no other child of this parent has (RAD_BRANCH_*)
 * False: do not trace r.  It is too weak or too deep (-lw, -lr), lost at
 * Russian roulette (with -lr <= 0, or as a small branch of a hemisphere's ray),
 * or its parent is infinitely long.
 * Roulette may have raised r->coef: multiply r->L by r->coef, not by *coef. */
bool rad_ray_spawn(struct rad_ctx *ctx, struct rad_ray *r,
                   enum rad_raykind kind, const struct rad_ray *parent,
                   const struct rad_rgb *coef, uint32_t branch);

/* Find what r meets, and its radiance.  Counts one ray.  r starts just off the
 * parent's surface, on the side to which r->dir leaves it.  May be called again
 * after dir and key have been changed. */
void rad_ray_trace(struct rad_ctx *ctx, struct rad_ray *r);

/* If spawned ray r, whose dir is set, goes on in its parent's direction, let it
 * use the parent's line of surfaces straight ahead. */
void rad_ray_onward(struct rad_ray *r);

/* Change r, which has met a surface, to the ray that goes straight on from
 * there, as rad_ray_spawn() would make it of r.  parent, org, line, and the
 * fields for what it met and brought back are left alone.  False: it is too
 * weak or too deep. */
bool rad_ray_go_on(const struct rad_ctx *ctx, struct rad_ray *r);

/* Forget what r met and brought back. */
void rad_ray_clear(struct rad_ray *r);

/* Fill the shading fields (n, cos_o, pert, pattern, dist) from r->hit. */
void rad_ray_enter(struct rad_ray *r);

/* Shade the hit with the modifier chain that begins with object mod; false: the
 * chain has no material. */
bool rad_ray_shade(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Shade the hit, after rad_ray_enter(), with its surface's material; pass the
 * ray on if there is none. */
void rad_ray_continue(struct rad_ctx *ctx, struct rad_ray *r);

/* Pass the ray on as if the surface were not there. */
void rad_ray_transmit(struct rad_ctx *ctx, struct rad_ray *r);

/* Let the medium between origin and hit dim r->L, and add the light that it
 * scatters.  The last step of rad_ray_trace(), and of shadow rays that are
 * shaded without it. */
void rad_ray_absorb(struct rad_ctx *ctx, struct rad_ray *r);

/* Apply the textures and patterns of the chain that begins with mod. */
void rad_ray_texture(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Smaller fractions of light count as 0.  As in Radiance, this decides which
 * parts a material has. */
#define RAD_TINY 1e-6

/* Has a texture tilted the normal, by more than RAD_TINY? */
static inline bool
rad_ray_perturbed(const struct rad_ray *r)
{
    return rad_dot(r->pert, r->pert) > RAD_TINY * RAD_TINY;
}

/* The perturbed unit normal; returns -dir.norm, whose sign is cos_o's. */
double rad_ray_normal(const struct rad_ray *r, double norm[3]);

/* Does the tilt of the normal turn light that passes through the surface?  Not
 * if the texture rounds off a faceted surface: Radiance's converters name such
 * a modifier "Phong". */
bool rad_ray_bends(const struct rad_ctx *ctx, const struct rad_ray *r);

/* Set `ahead` to the direction of light that passes through: straight on, or
 * turned by the tilt of the normal, as long as it still leads through the
 * surface.  r->n must be on the side that the ray comes from. */
void rad_ray_ahead(const struct rad_ctx *ctx, const struct rad_ray *r,
                   double ahead[3]);

/* Turn n, cos_o and pert to the other side. */
void rad_ray_flip(struct rad_ray *r);

/* The first step of shading a surface whose two sides are alike: apply patterns
 * and textures from mod on, and turn r's normal to the side that was hit.
 * False: that is a back, and invisible (-bv-); r is shaded with what lies
 * behind it. */
bool rad_ray_face(struct rad_ctx *ctx, struct rad_ray *r, int32_t mod);

/* Did r meet a flat surface, a polygon or ring?  (An image in a flat mirror
 * looks as far away as the light's way is long.) */
bool rad_ray_on_flat(const struct rad_ctx *ctx, const struct rad_ray *r);

/* Does dir point to the side of the hit that the ray does not come from? */
bool rad_ray_through(const struct rad_ray *r, const double dir[3]);

/* The distance that rpict -z writes: the effective distance of the brighter
 * part of r's light; 1e10, as there, if it is infinite. */
double rad_ray_distance(const struct rad_ray *r);

/* The distance that a child, traced from a ray's hit, adds to the ray's
 * effective distance.  As in rpict the child's mirrored light is compared with
 * its light times its coefficient, not with all its light: so behind a dim
 * surface the mirrored part counts sooner. */
double rad_ray_way_of(const struct rad_ray *child);

/* Trace a mirrored child, whose dir may have any length, and add its light to
 * r's.  clear: the image counts as being as far away as it looks; else as far
 * away as the mirror. */
void rad_ray_mirror(struct rad_ctx *ctx, struct rad_ray *r,
                    struct rad_ray *child, bool clear);

/* Make *r a primary ray that met a surface at p with unit normal n, whether or
 * not there is one, and set r->L to the irradiance there [W/m^2].
 * A surface through p, to the precision of six written digits, is behind p. */
void rad_ray_irradiance(struct rad_ctx *ctx, struct rad_ray *r,
                        const double p[3], const double n[3], uint64_t key);

/* Make the same ray *r, without any light. */
void rad_ray_place(struct rad_ctx *ctx, struct rad_ray *r, const double p[3],
                   const double n[3], uint64_t key);

#endif
