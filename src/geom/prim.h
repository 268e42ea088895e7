/* prim.h - one surface, compiled for intersection (inside geom/ only)
 *
 * Each family of surfaces (polygon.c sphere.c cone.c ring.c) has the same four
 * functions:
 *   rad_X_make     compile an object; false if it is degenerate (no area)
 *   rad_X_bounds   bounds, before they are widened by the slack
 *   rad_X_hit      the first t in (tmin, tmax) where the ray meets the surface
 *   rad_X_surface  point, normal and error bound of a hit found by rad_X_hit
 *
 * Rounding.  u = 2^-53 is the unit roundoff of double.  Every computed
 * distance to a surface is a sum of a few products, each bounded by one of
 * |org|_1, t, or a coordinate of the surface, and each rounded fewer than
 * eight times; so its error is below
 *      RAD_GEOM_ROUND * (|org|_1 + t + |coordinates|),   RAD_GEOM_ROUND = 8u
 * (the running error analysis of Higham 2002, Accuracy and Stability of
 * Numerical Algorithms, section 3.3, as applied to rays in Pharr, Jakob &
 * Humphreys, Physically Based Rendering, 4th ed., section 6.8).  The last
 * term does not depend on the ray and is kept as `slack`. */
#ifndef RAD_GEOM_PRIM_H
#define RAD_GEOM_PRIM_H

#include "base/arena.h"
#include "base/vec.h"
#include "geom/geom.h"
#include "scene/scene.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define RAD_GEOM_ROUND 0x1p-50
#define RAD_GEOM_BACK  64 /* most bounds of a hit's error: rad_geom_leave() */

/* Coordinates must be below this: beyond it slack leaves the range of float,
 * and soon products the range of double. */
#define RAD_GEOM_MOST 0x1p+170

enum rad_prim_kind {
    PRIM_POLYGON,
    PRIM_SPHERE,
    PRIM_CONE, /* cone, cup, cylinder, tube */
    PRIM_RING,
    PRIM_WARPED, /* a polygon that is not flat */
    PRIM_PLACE   /* instance, mesh: see place.h */
};

struct rad_cone;  /* cone.c */
struct rad_place; /* place.h */

struct rad_prim {
    double k[4]; /* polygon, ring: unit normal n and n.p of the plane;
                  * sphere: centre and radius; cone, place: unused */
    union {
        const double *v; /* polygon: vertices, see rad_polygon_lay(); ring:
                          * the object's arguments */
        const struct rad_cone *cone;
        const struct rad_place *place;
    };
    int32_t obj;  /* index in the scene */
    int32_t nv;   /* polygon: number of vertices */
    float slack;  /* error bound of a hit that its own numbers cause */
    uint8_t kind; /* enum rad_prim_kind */
    uint8_t surf; /* RAD_SURF_ bits of the object; for a place without a
                   * modifier OPAQUE, since something in it may be */
    int8_t side;  /* sphere, cone: 1 normal outward, -1 inward */
};

/* Four numbers at a time, as vectors of the compiler: whether these are two
 * registers, one or none, each element goes through the same operations and has
 * the same bits. */
typedef double rad_v4d __attribute__((vector_size(32)));
typedef int64_t rad_v4i __attribute__((vector_size(32)));

/* A ray with values that every test needs. */
struct rad_probe {
    double org[3], dir[3];
    double rcp[3];  /* 1/dir */
    double size;    /* |org|_1 */
    int kx, ky, kz; /* axes; dir is longest along kz */
    double sx, sy;  /* shear that turns dir into the kz axis */
};

struct rad_box {
    double lo[3], hi[3];
};

static inline void
rad_probe_init(struct rad_probe *r, const struct rad_span *span)
{
    const double *org = span->org, *dir = span->dir;
    double ax = fabs(dir[0]), ay = fabs(dir[1]), az = fabs(dir[2]);
    int k = ay > ax ? 1 : 0;

    k = az > (k ? ay : ax) ? 2 : k;
    rad_copy(r->org, org);
    rad_copy(r->dir, dir);
    r->rcp[0] = 1 / dir[0];
    r->rcp[1] = 1 / dir[1];
    r->rcp[2] = 1 / dir[2];
    r->size = fabs(org[0]) + fabs(org[1]) + fabs(org[2]);
    r->kx = k == 2 ? 0 : k + 1;
    r->ky = k == 0 ? 2 : k - 1;
    r->kz = k;
    r->sx = dir[r->kx] * r->rcp[k];
    r->sy = dir[r->ky] * r->rcp[k];
}

/* Is this a type of surface with a family here? */
bool rad_prim_has(enum rad_otype type);

/* Compile object o, which is no instance or mesh.  False: it has no area or is
 * no surface, or memory is out, which sets *nomem. */
bool rad_prim_make(struct rad_prim *p, const struct rad_object *o,
                   struct rad_arena *arena, bool *nomem);

bool rad_polygon_make(struct rad_prim *p, const struct rad_object *o);
bool rad_sphere_make(struct rad_prim *p, const struct rad_object *o);
bool rad_ring_make(struct rad_prim *p, const struct rad_object *o);
bool rad_cone_make(struct rad_prim *p, const struct rad_object *o,
                   struct rad_arena *arena, bool *nomem);

/* Are all coordinates below RAD_GEOM_MOST, so that no square overflows? */
bool rad_prim_bounded(const struct rad_prim *p);

/* Bounds that contain every point that a hit can have. */
void rad_prim_bounds(const struct rad_prim *p, struct rad_box *box);

/* What the test of a warped face needs besides its vertices. */
struct rad_warp {
    struct rad_box box; /* of the vertices */
    double most;        /* how far from the plane one of them is */
};

/* The number of a polygon's vertices in the layout of the test. */
static inline size_t
rad_polygon_laid(const struct rad_prim *p)
{
    return ((size_t)p->nv + 3) & ~(size_t)3;
}

/* The number of doubles that rad_polygon_lay() needs. */
static inline size_t
rad_polygon_room(const struct rad_prim *p)
{
    return 3 * rad_polygon_laid(p) +
           (p->kind == PRIM_WARPED ? sizeof(struct rad_warp) / sizeof(double)
                                   : 0);
}

/* Copy the vertices of a compiled polygon to `to`, which must live as long as
 * p, in the layout of the test: all x, all y, all z, each filled up to a
 * multiple of four with the first vertex's; a warped face's struct rad_warp
 * follows.  rad_prim_bounds() works only before this. */
void rad_polygon_lay(struct rad_prim *p, double *to);

/* Does all of p have one normal, p->k? */
static inline bool
rad_prim_is_flat(const struct rad_prim *p)
{
    return p->kind == PRIM_POLYGON || p->kind == PRIM_WARPED ||
           p->kind == PRIM_RING;
}

void rad_polygon_bounds(const struct rad_prim *p, struct rad_box *box);
void rad_sphere_bounds(const struct rad_prim *p, struct rad_box *box);
void rad_ring_bounds(const struct rad_prim *p, struct rad_box *box);
void rad_cone_bounds(const struct rad_prim *p, struct rad_box *box);
void rad_place_bounds(const struct rad_prim *p, struct rad_box *box);

/* A sphere and a cone are met twice: t[1] gets the distance of the second hit,
 * or INFINITY, if there is none before tmax. */
bool rad_sphere_hit(const struct rad_prim *p, const struct rad_probe *r,
                    double tmin, double tmax, double t[2]);
bool rad_cone_hit(const struct rad_prim *p, const struct rad_probe *r,
                  double tmin, double tmax, double t[2]);
bool rad_ring_hit(const struct rad_prim *p, const struct rad_probe *r,
                  double tmin, double tmax, double *t);

/* Set p, n and err of a hit; hit->t is set. */
void rad_plane_surface(const struct rad_prim *p, const struct rad_probe *r,
                       struct rad_hit *hit);
void rad_sphere_surface(const struct rad_prim *p, const struct rad_probe *r,
                        struct rad_hit *hit);
void rad_cone_surface(const struct rad_prim *p, const struct rad_probe *r,
                      struct rad_hit *hit);

/* Note that a ray of direction dir made the hit. */
static inline void
rad_hit_come(struct rad_hit *hit, const double dir[3])
{
    for (int k = 0; k < 3; k++)
        hit->way[k] = (float)dir[k];
}

/* Set all of *hit for a hit at t. */
void rad_prim_surface(const struct rad_prim *p, const struct rad_probe *r,
                      double t, struct rad_hit *hit);

#endif
