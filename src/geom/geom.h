/* geom.h - where rays meet the surfaces of a scene
 *
 * The surfaces of a scene are compiled into primitives, with one file for each
 * family, and a BVH of width 8 over them (bvh.h).  It answers two questions:
 * which surface does this ray meet first, and is anything opaque in its way?
 * Only this folder knows where a primitive's data lies.
 * Sources (`source` surfaces) are at infinity and not part of it: see
 * light/direct/source.h.
 * An instance or a mesh is one primitive that holds a transform and points to
 * the surfaces that it is a copy of, which all copies share (place.h).
 * Points are double[3] in world space.  There is no absolute epsilon: a hit
 * carries a bound of its own rounding error, and rays start beyond it.
 * Thread: immutable once made; rays may be traced from any thread. */
#ifndef RAD_GEOM_GEOM_H
#define RAD_GEOM_GEOM_H

#include "base/error.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

struct rad_geom;

/* Properties of a surface's material that intersection needs. */
enum {
    RAD_SURF_OPAQUE = 1,      /* its material stops every shadow ray */
    RAD_SURF_TRANSPARENT = 2, /* loses ties against others (tie rule) */
    RAD_SURF_NOMATERIAL = 4,  /* loses ties against all that have a material */
    RAD_SURF_PASSED = 8,      /* most rays that meet it go straight on */
    RAD_SURF_ONESIDED = 16,   /* most rays that meet its back go straight on */
    RAD_SURF_LAMP = 32        /* gives light */
};

/* Two surfaces that are meant to be flush may be apart by this part of their
 * coordinates: frozen octrees keep 31 bits of these, xform writes 12 digits. */
#define RAD_GEOM_FLUSH 0x1p-28

/* A stretch of a line: p(t) = org + t*dir, tmin < t < tmax. */
struct rad_span {
    double org[3];
    double dir[3]; /* unit length */
    double tmin;   /* >= 0 */
    double tmax;   /* INFINITY: no end */
};

struct rad_hit {
    double t;     /* distance [scene units] */
    double p[3];  /* the point, on the surface to within err */
    double n[3];  /* unit normal as the surface defines it, not turned to the
                   * ray: outward of polygon (right-hand rule), sphere, cone,
                   * cylinder; inward of bubble, cup, tube */
    double err;   /* bound of |p - surface| [scene units] */
    float way[3]; /* direction of the ray that hit, rounded; 0: no ray */
    double uv[2]; /* local coordinates if the surface has some, else 0 */
    int32_t obj;  /* index in the scene, RAD_VOID: nothing hit.  For a surface
                   * in an instance or mesh with a modifier of its own, that
                   * instance or mesh */
    bool bent;    /* bend is set: the surface looks curved */
    const struct rad_geom *in; /* not NULL: the surface is in a copy, told by
                                * `copy`; see rad_geom_place() */
    uint64_t copy;
    double bend[3]; /* to be added to n for the normal of the curved surface
                     * that a mesh stands for */
};

/* Surfaces that a ray meets one after the other if it goes straight on, found
 * in one walk.  Filled in scenes that have surfaces that are passed
 * (RAD_SURF_PASSED). */
#define RAD_LINE_MOST 8
struct rad_line {
    int n;     /* surfaces known */
    bool open; /* there may be more behind the last */
    struct {
        double t;      /* distance from the line's origin */
        uint32_t item; /* the tree's item */
    } at[RAD_LINE_MOST];
};

/* Instances within instances can make this many copies, because a number of 64
 * bits tells them apart (0: not in a copy).  More is RAD_EDATA. */
#define RAD_GEOM_COPIES 0x1p64

/* Counted per thread by the caller's context. */
struct rad_geom_counts {
    uint64_t tests; /* ray/primitive intersection tests */
    uint64_t nodes; /* BVH nodes visited */
};

/* Compile.  surf[i] holds the RAD_SURF_ bits of object i (0 for modifiers).
 * rays: how many will be traced, about; 0: very many.  For few it is made
 * sooner and traced slower; they meet the same.  The scene must outlive the
 * result.  NULL and *err on failure.  Degenerate surfaces (without area, or
 * with coordinates that are no numbers or beyond 2^170) are left out without an
 * error. */
struct rad_geom *rad_geom_new(const struct rad_scene *scene,
                              const uint8_t *surf, uint32_t rays,
                              struct rad_error *err);
void rad_geom_free(struct rad_geom *g);

/* The transform of the copy that was hit: from the coordinates of its file to
 * the world's.  False: the surface is in no copy. */
struct rad_xform;
bool rad_geom_place(const struct rad_hit *hit, struct rad_xform *move);

/* Bounds of all finite surfaces; an empty scene gives lo = hi = 0. */
void rad_geom_bounds(const struct rad_geom *g, double lo[3], double hi[3]);

/* How long the surface that was hit is, or the copy that it is in, by the
 * diagonal of a box or the edge of a cube around it. */
double rad_geom_size(const struct rad_geom *g, const struct rad_hit *hit);

/* The first surface on the span.  Among hits within their error bounds of the
 * nearest the tie rule decides: opaque over transparent, front over back, the
 * modifier that is defined later (a lamp's over one of a copy), then the higher
 * object index.  With an opaque surface the front of a lamp ties also where
 * what scene files round has put the lamp behind.  False: nothing is hit
 * (hit->obj is RAD_VOID). */
bool rad_geom_nearest(const struct rad_geom *g, const struct rad_span *span,
                      struct rad_hit *hit, struct rad_geom_counts *counts);

/* Of two surfaces of the scene's own in one place, their fronts on the same
 * side: does the tie rule choose a, and not b? */
bool rad_geom_outranks(const struct rad_geom *g, int32_t a, int32_t b);

/* The same, and fill *line with the surfaces up to the first that is not
 * passed, that one included; hit is the line's first entry.  The line stays
 * empty in a scene without surfaces that are passed. */
bool rad_geom_first(const struct rad_geom *g, const struct rad_span *span,
                    struct rad_hit *hit, struct rad_line *line,
                    struct rad_geom_counts *counts);

/* The object of the line's surface number i; RAD_VOID: the line ends before. */
int32_t rad_geom_ahead(const struct rad_geom *g, const struct rad_line *line,
                       int i);

/* Does the span, along which *line was found, meet surface number i on its
 * front? */
bool rad_geom_faces(const struct rad_geom *g, const struct rad_line *line,
                    int i, const struct rad_span *span);

/* Has the scene surfaces that are passed? */
bool rad_geom_passes(const struct rad_geom *g);

/* The surface behind the hit `last`, which is number i - 1 of the line, for a
 * ray that goes on from org in the same direction.  MET: *hit gets it, with its
 * distance from last->p.  NONE: there is none.  UNKNOWN: the line ends here, or
 * the next surface is too near to the last; ask rad_geom_first(). */
enum rad_beyond { RAD_BEYOND_NONE, RAD_BEYOND_MET, RAD_BEYOND_UNKNOWN };
enum rad_beyond rad_geom_beyond(const struct rad_geom *g,
                                const struct rad_line *line, int i,
                                const struct rad_hit *last, const double org[3],
                                const double dir[3], struct rad_hit *hit);

/* Does a surface with RAD_SURF_OPAQUE, other than object `skip` (RAD_VOID:
 * none), meet the span?  BLOCKED: the walk stopped at the first such surface.
 * *blocker is the caller's memory of the last object that blocked (RAD_VOID:
 * none): it is tested first, and gets the object that blocks now.  A blocked
 * span then counts as one test, so that counts do not depend on the memory.
 * blocker may be NULL.  If nothing opaque is in the way: does anything else
 * meet the span, which may dim or turn the light?  VEILED: *hit gets the first
 * such surface, as rad_geom_nearest() would, and *line the surfaces that
 * follow.  Object `skip` does not count, unless the tie rule prefers it. */
enum rad_sight { RAD_SIGHT_CLEAR, RAD_SIGHT_VEILED, RAD_SIGHT_BLOCKED };
enum rad_sight rad_geom_sight(const struct rad_geom *g,
                              const struct rad_span *span, int32_t skip,
                              int32_t *blocker, struct rad_hit *hit,
                              struct rad_line *line,
                              struct rad_geom_counts *counts);

/* Test one surface alone: the light source that a shadow ray aims at. */
bool rad_geom_hit_object(const struct rad_geom *g, int32_t obj,
                         const struct rad_span *span, struct rad_hit *hit,
                         struct rad_geom_counts *counts);

/* The origin of a ray that leaves the surface at hit in direction dir: at least
 * two error bounds off the surface, on dir's side, once for the unknown place
 * of the surface, once for the rounding of the next test.  If dir leads back to
 * the side that the ray of the hit came from, the point is drawn back along
 * that ray, on which nothing was in the way; else, and where the ray comes all
 * but along the surface, it is moved along the normal.  So at an edge where
 * surfaces meet, the new ray starts in front of all of them and does not slip
 * out between them. */
void rad_geom_leave(const struct rad_hit *hit, const double dir[3],
                    double org[3]);

#endif
