/* smooth.h - irradiance at places on surfaces, with less noise than each has
 *
 * Places side by side see nearly the same, each with a noise of its own, whose
 * variance is known.  What a place is taken to have is a fit through its
 * neighbours (quadric.h), as far as these agree with one within their noise;
 * where they do not, its own measurement.  Nobody is a neighbour whose normal
 * differs, who lies off the surface, or behind something that stands on it.
 * Values are made when they are asked for, each once: of many workers each
 * makes those that its part of the picture shows, and all make the same.
 * Units: lengths are scene units, E is irradiance [W/m^2].
 * Thread: one makes and frees it; any number may ask at once, and none waits
 * for another.  */
#ifndef RAD_LIGHT_SMOOTH_H
#define RAD_LIGHT_SMOOTH_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A fence, and with it all neighbours, is so many times a place's `reach'. */
#define RAD_SMOOTH_REACH 5

/* What is known of a place. */
struct rad_smooth_place {
    double p[3];
    float n[3], u[3], v[3]; /* unit: its normal, and axes of its plane */
    float E[3];
    float gpos[2];  /* gradient of ln E along u, v [1/unit] */
    float gdir[2];  /* about u, v [1/rad] */
    float var;      /* variance of E's luminance over its square; negative: not
                     * known, and the place is left alone */
    float reach;    /* in which E is about linear */
    float bend;     /* E'' / E that is expected [1/unit^2] */
    uint32_t fence; /* for each 16th of a turn from u toward v two bits: how
                     * often RAD_SMOOTH_REACH * reach is to be halved for that
                     * part of the circle to be free of what stands on the
                     * surface; 3: more than twice */
};

/* What it is taken to have. */
struct rad_smooth_value {
    float E[3], gpos[2], var;
};

/* Where n places are known, by number. */
struct rad_smooth_source {
    const void *arg;
    uint32_t n;                                          /* below 2^30 */
    const double *(*point)(const void *arg, uint32_t i); /* p of place i */
    void (*place)(const void *arg, uint32_t i, struct rad_smooth_place *place);
};

struct rad_smooth;

/* What source->arg is must stay as it is.  NULL: out of memory. */
struct rad_smooth *rad_smooth_new(const struct rad_smooth_source *source);
void rad_smooth_free(struct rad_smooth *s);

/* The value at place i < n. */
void rad_smooth_at(struct rad_smooth *s, uint32_t i,
                   struct rad_smooth_value *v);

/* Bytes that it takes. */
size_t rad_smooth_bytes(const struct rad_smooth *s);

/* Which of 32 parts of a turn from u toward v the direction (u, v) is in. */
static inline unsigned
rad_part_of_turn(float u, float v)
{
    /* tangents of one, two and three parts */
    const float one = .198912367f, two = .414213562f, three = .668178638f;
    float x = fabsf(u), y = fabsf(v), lo = x < y ? x : y, hi = x < y ? y : x;
    unsigned part = (unsigned)(lo > one * hi) + (unsigned)(lo > two * hi) +
                    (unsigned)(lo > three * hi);

    part = x < y ? 7 - part : part;
    part = u < 0 ? 15 - part : part;
    return v < 0 ? 31 - part : part;
}

#endif
