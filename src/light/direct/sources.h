/* sources.h - the list of light sources (inside light/direct only) */
#ifndef RAD_LIGHT_SOURCES_H
#define RAD_LIGHT_SOURCES_H

#include "light/sample/sample.h"
#include "light/direct/source.h"
#include "light/direct/virtual.h"

#include <math.h>

#include "arith/elementary.h"

/* rad_share_of() of fewer samples than this is read from a table: to compute
 * the power at each point takes longer than many a shadow ray. */
#define RAD_FEW_SAMPLES 64

/* Bound of the rounding error of a few dozen operations on coordinates,
 * relative to the largest coordinate. */
#define RAD_LIGHT_ROUNDING 0x1p-46

struct rad_sources {
    struct rad_source *list;
    int32_t n;
    int32_t nlit;     /* sources that give direct light: not RAD_LIGHT_SKIP */
    int32_t *distant; /* indices of distant sources, in scene order */
    int32_t ndistant;
    struct rad_virtual *virtuals; /* source i >= n is virtuals[i - n] */
    int32_t nvirtuals;
    int32_t share[RAD_FEW_SAMPLES]; /* share[n]: rad_share_of() n samples */
};

/* How many of n samples are taken together when their sum is compared with -dt:
 * n to the power of -dc, rounded. */
static inline int32_t
rad_share_of(int32_t n, double certainty)
{
    return (int32_t)rad_least(n, rad_pow(n, certainty) + .5);
}

/* The largest absolute coordinate of v. */
static inline double
rad_largest(const double v[3])
{
    return rad_most(fabs(v[0]), rad_most(fabs(v[1]), fabs(v[2])));
}

/* What may stand before a surface at p with normal n, and count as flush with
 * it, where the way begins at that height above the surface. */
static inline double
rad_flush_gap(const double p[3], const double n[3], double height)
{
    return rad_least(RAD_GEOM_FLUSH * rad_dot_sizes(n, p), height / 2);
}

/* rad_source_object(), inline for shadow rays. */
static inline int32_t
rad_source_target(const struct rad_sources *s, int32_t i)
{
    return i < s->n ? s->list[i].obj : s->virtuals[i - s->n].mirror;
}

/* Is i a distant source?  False of its images. */
static inline bool
rad_source_distant(const struct rad_sources *s, int32_t i)
{
    return i < s->n && s->list[i].flags & RAD_LIGHT_DISTANT;
}

/* Image i; NULL: i is a source. */
static inline const struct rad_virtual *
rad_source_virtual(const struct rad_sources *s, int32_t i)
{
    return i < s->n ? NULL : &s->virtuals[i - s->n];
}

/* Source i, or the source at the end of the way that image i shows. */
static inline const struct rad_source *
rad_source_root(const struct rad_sources *s, int32_t i)
{
    return &s->list[i < s->n ? i : s->virtuals[i - s->n].root];
}

#endif
