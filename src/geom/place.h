/* place.h - copies: instances and meshes (inside geom/ only)
 *
 * A set is a tree over surfaces: the scene's own, or those of one of its parts.
 * A place is a surface of a set that stands for another set under a transform.
 * A ray that meets a place's bounds is turned into the coordinates of that set,
 * walks its tree, and the hit is carried back.
 *
 * The turned direction has unit length, so a distance inside is `len` times the
 * distance outside.  m is the scale times a rotation or reflection, made
 * orthogonal to the last bits, whatever product of transforms it came from.
 * Which side of a surface a ray is on is computed inside, from the surface's
 * own numbers, so faces of a copy share edges as those of the original do.
 *
 * Rounding (prim.h).  Turning the ray moves its origin by fewer than eight
 * roundings of |m^-1||org| + |t'|; this is added to probe.size, which bounds
 * the error of every test.  A point that is carried back is off by its own
 * error, scaled, and by as many roundings of |m||p| + |t|.  A ray that leaves
 * it is turned again, like any ray, so the hit's error bound has room for both.
 *
 * A triangle of a mesh has integer coordinates, as in its file; the place's
 * transform includes the one from integers to coordinates.
 *
 * One number tells copies apart.  In a set with n places, number 0 means in no
 * place, and 1 + i + n k means number k inside place i. */
#ifndef RAD_GEOM_PLACE_H
#define RAD_GEOM_PLACE_H

#include "geom/bvh.h"

struct rad_set {
    struct rad_bvh bvh;
    struct rad_prim *prims; /* in the tree's order; NULL: the set is a mesh */
    struct rad_meshed *meshed;
    uint32_t nprims;
    const struct rad_place **places; /* by number - 1 */
    uint32_t nplaces;
    double copies; /* how many numbers tell its copies apart; 1: no places */
};

struct rad_place {
    const struct rad_set *set; /* what the place is a copy of */
    const struct rad_use *use;
    double m[3][3], t[3];       /* p outside = p inside * m + t */
    double back[3][3], from[3]; /* the inverse */
    double scale, size;         /* |m|, |t|_1 */
    double len;                 /* 1 / scale */
    uint32_t number;            /* 1 + index among the places of its set */
    bool covers;                /* its modifier replaces the surfaces' own */
};

/* Make p a copy of set.  False: the set is empty, or the transform is out of
 * range, or memory is out, which sets *nomem. */
bool rad_place_make(struct rad_prim *p, const struct rad_object *o,
                    const struct rad_set *set, uint8_t surf, uint32_t number,
                    struct rad_arena *arena, bool *nomem);

/* Let the walk go through the place that is its item i, for this purpose. */
enum rad_meet { RAD_MEET_NEAREST, RAD_MEET_ANY, RAD_MEET_ALL };
/* True: a walk for RAD_MEET_ANY met something opaque. */
bool rad_place_meet(struct rad_walk *w, uint32_t i, enum rad_meet how);

/* Fill *met for a hit at t on the tree's item i. */
void rad_walk_met(const struct rad_walk *w, uint32_t i, double t,
                  struct rad_met *met);

/* Set up a walk through a set; the caller sets probe, tmin, tmax and cut. */
static inline void
rad_walk_start(struct rad_walk *w, const struct rad_geom *g,
               const struct rad_set *set)
{
    w->bvh = &set->bvh;
    w->prims = set->prims;
    w->meshed = set->meshed;
    w->geom = g;
    w->set = set;
    w->best = INFINITY;
    w->prim = RAD_NO_PRIM;
    w->tie = false;
    w->skip = RAD_VOID;
    w->veiled = false;
    w->vague = false;
    w->line = NULL;
    w->keep = 0xff;
    w->give = 0;
    w->tests = w->nodes = 0;
}

#endif
