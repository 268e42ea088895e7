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

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What is known of a place. */
struct rad_smooth_place {
    double p[3];
    float n[3], u[3], v[3]; /* unit: its normal, and axes of its plane */
    float E[3];
    float gpos[2]; /* gradient of ln E along u, v [1/unit] */
    float gdir[2]; /* about u, v [1/rad] */
    float var;     /* variance of E's luminance over its square; negative: not
                    * known, and the place is left alone */
    float reach;   /* in which E is about linear */
    float bend;    /* E'' / E that is expected [1/unit^2] */
};

/* What it is taken to have. */
struct rad_smooth_value {
    float E[3], gpos[2], var;
};

/* Where n places are known, by number, and what stands between two of them. */
struct rad_smooth_source {
    const void *arg;
    uint32_t n;                                          /* below 2^30 */
    const double *(*point)(const void *arg, uint32_t i); /* p of place i */
    void (*place)(const void *arg, uint32_t i, struct rad_smooth_place *place);
    bool (*are_parted)(const void *arg, const struct rad_smooth_place *a,
                       const struct rad_smooth_place *b);
};

struct rad_smooth;

/* What source->arg is must stay as it is.  NULL: out of memory. */
struct rad_smooth *rad_smooth_new(const struct rad_smooth_source *source);
void rad_smooth_free(struct rad_smooth *s);

/* The value at place i < n. */
void rad_smooth_at(struct rad_smooth *s, uint32_t i,
                   struct rad_smooth_value *v);

/* The value at another place, which is nobody's neighbour itself. */
void rad_smooth_beside(const struct rad_smooth *s,
                       const struct rad_smooth_place *at,
                       struct rad_smooth_value *v);

/* Bytes that it takes. */
size_t rad_smooth_bytes(const struct rad_smooth *s);

#endif
