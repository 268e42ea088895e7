/* geom.h - where rays meet the surfaces of a scene
 *
 * Compiles the surfaces of a scene into a BVH of width 8 (bvh.h) over
 * primitives with one file per family, and answers two questions: what does
 * this ray meet first, and does anything opaque stand in its way.  Only this
 * folder knows where a primitive's data lies.
 * Sources (`source` surfaces) are at infinity and have no place here: see
 * light/direct/source.h.
 * An instance or a mesh is one primitive that holds a transform and points to
 * what it is a copy of, which all copies share (place.h).
 * Points are double[3] in world space.  No absolute epsilon: a hit carries the
 * bound of its own rounding error, and rays are started beyond it.
 * Thread: immutable once made; rays may be traced from any thread. */
#ifndef RAD_GEOM_GEOM_H
#define RAD_GEOM_GEOM_H

#include "base/error.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

struct rad_geom;

/* What shading knows of a surface and intersection must know too. */
enum {
    RAD_SURF_OPAQUE = 1,      /* its material stops every shadow ray */
    RAD_SURF_TRANSPARENT = 2, /* loses ties against what is not (tie rule) */
    RAD_SURF_NOMATERIAL = 4,  /* loses ties against all that has one */
    RAD_SURF_PASSED = 8,      /* what meets it mostly goes straight on, */
    RAD_SURF_ONESIDED = 16    /* or what meets its back, at least */
};

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
    float way[3]; /* direction of the ray that met it, about; 0: none did */
    double uv[2]; /* local coordinates where the surface has some, else 0 */
    int32_t obj;  /* index in the scene, RAD_VOID: nothing hit.  What an
                   * instance or mesh with a modifier of its own holds counts
                   * as that instance or mesh */
    bool bent;    /* bend is set: the surface looks curved */
    const struct rad_geom *in; /* NULL: not within a copy; else copy says
                                * within which: rad_geom_place() */
    uint64_t copy;
    double bend[3]; /* what turns n into the normal of the curved surface that
                     * a mesh stands for */
};

/* What a ray meets one after the other, if it goes straight on: found in one
 * walk.  Filled where there are surfaces that are passed (RAD_SURF_PASSED). */
#define RAD_LINE_MOST 8
struct rad_line {
    int n;     /* how many are known */
    bool open; /* behind the last of them there may be more */
    struct {
        double t;      /* distance from the line's origin */
        uint32_t item; /* of the tree */
    } at[RAD_LINE_MOST];
};

/* Instances within instances may make this many copies, 0 for what is none:
 * a number of 64 bits tells them apart.  More is RAD_EDATA. */
#define RAD_GEOM_COPIES 0x1p64

/* Counted per thread by the caller's context. */
struct rad_geom_counts {
    uint64_t tests; /* ray/primitive intersection tests */
    uint64_t nodes; /* BVH nodes visited */
};

/* Compile.  surf[i] holds the RAD_SURF_ bits of object i (0 for modifiers).
 * The scene must outlive the result.  NULL and *err on failure; a degenerate
 * surface (no area, or coordinates that are no numbers or beyond 2^170) is
 * left out, not an error. */
struct rad_geom *rad_geom_new(const struct rad_scene *scene,
                              const uint8_t *surf, struct rad_error *err);
void rad_geom_free(struct rad_geom *g);

/* The transform that brought what was hit to its place: from the coordinates
 * of the file that holds it to the world's.  False: it lies there as it is. */
struct rad_xform;
bool rad_geom_place(const struct rad_hit *hit, struct rad_xform *move);

/* Bounds of all finite surfaces; an empty scene gives lo = hi = 0. */
void rad_geom_bounds(const struct rad_geom *g, double lo[3], double hi[3]);

/* The first surface on the span.  Among hits within their error bounds of the
 * nearest the tie rule decides: opaque over transparent, front over back, the
 * modifier defined later, at last the higher object index.  False: nothing hit
 * (hit->obj is RAD_VOID). */
bool rad_geom_nearest(const struct rad_geom *g, const struct rad_span *span,
                      struct rad_hit *hit, struct rad_geom_counts *counts);

/* The same; *line gets what was met on the way to the first surface that is not
 * passed, this one too; nothing where no surface ever is.  hit is its first
 * entry. */
bool rad_geom_first(const struct rad_geom *g, const struct rad_span *span,
                    struct rad_hit *hit, struct rad_line *line,
                    struct rad_geom_counts *counts);

/* The object that is number i of the line; RAD_VOID: it does not tell. */
int32_t rad_geom_ahead(const struct rad_geom *g, const struct rad_line *line,
                       int i);

/* Does the span, along which *line was found, meet number i on its front? */
bool rad_geom_faces(const struct rad_geom *g, const struct rad_line *line,
                    int i, const struct rad_span *span);

/* Are there surfaces that are passed? */
bool rad_geom_passes(const struct rad_geom *g);

/* What is behind the hit `last`, which was number i - 1 of the line, in the
 * same direction?  MET: *hit gets that, at its distance from last->p.  UNKNOWN:
 * ask rad_geom_first(); too much is there for the line to tell, or too near. */
enum rad_beyond { RAD_BEYOND_NONE, RAD_BEYOND_MET, RAD_BEYOND_UNKNOWN };
enum rad_beyond rad_geom_beyond(const struct rad_geom *g,
                                const struct rad_line *line, int i,
                                const struct rad_hit *last, const double org[3],
                                const double dir[3], struct rad_hit *hit);

/* Does a surface with RAD_SURF_OPAQUE, other than object `skip` (RAD_VOID:
 * none), meet the span?  Stops at the first one found; *blocker (may be NULL)
 * gets its index, and if it holds an index on entry that one is tested first
 * (the caller's memory of the last occluder).  With such a memory a span that
 * is blocked counts as one test, so that what counts does not depend on it. */
bool rad_geom_occluded(const struct rad_geom *g, const struct rad_span *span,
                       int32_t skip, int32_t *blocker,
                       struct rad_geom_counts *counts);

/* The same, and where nothing opaque is in the way: does anything else meet the
 * span, something that could dim or turn the light?  VEILED: *hit gets the
 * first such surface (of all but object `skip`, if the tie rule does not
 * prefer that), as rad_geom_nearest() would, and *line all that follow. */
enum rad_sight { RAD_SIGHT_CLEAR, RAD_SIGHT_VEILED, RAD_SIGHT_BLOCKED };
enum rad_sight rad_geom_sight(const struct rad_geom *g,
                              const struct rad_span *span, int32_t skip,
                              int32_t *blocker, struct rad_hit *hit,
                              struct rad_line *line,
                              struct rad_geom_counts *counts);

/* Test one surface alone (a light source that a shadow ray aims at). */
bool rad_geom_hit_object(const struct rad_geom *g, int32_t obj,
                         const struct rad_span *span, struct rad_hit *hit,
                         struct rad_geom_counts *counts);

/* Where a ray that leaves the surface at hit in direction dir starts: the point
 * moved along the normal, to dir's side, by twice the bound of its error (once
 * for where the surface is, once for the next test's own rounding).  Back on
 * the side of the ray that met it the point is first drawn back along that ray
 * by a few bounds: where surfaces meet it so starts in front of all of them,
 * and does not go out through another's edge. */
void rad_geom_leave(const struct rad_hit *hit, const double dir[3],
                    double org[3]);

#endif
