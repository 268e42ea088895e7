/* smooth.h - irradiance at places on surfaces, smoothed over neighbours
 *
 * Places side by side have nearly the same irradiance, and each has measured
 * its own with noise of a known variance.  A place's smoothed value is a fit
 * through its neighbours' measurements (quadric.h), as far as these agree with
 * the fit within their noise; where they do not, it is the place's own
 * measurement.  Places are no neighbours if their normals differ, if they are
 * off each other's plane, or if something that stands on the surface parts
 * them.
 * A value is made when it is first asked for, and kept.  Each of many workers
 * makes the values that its part of the picture shows; the value of a place is
 * the same on all workers.
 * Units: lengths are scene units, E is irradiance [W/m^2].
 * Thread: one thread makes and frees a struct rad_smooth; any number of threads
 * may ask for values at once, and none waits for another.  */
#ifndef RAD_LIGHT_SMOOTH_H
#define RAD_LIGHT_SMOOTH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A place and its measurement. */
struct rad_smooth_place {
    double p[3];
    float n[3], u[3], v[3]; /* unit: its normal, and axes of its plane */
    float E[3];
    float gpos[2]; /* gradient of ln E along u, v [1/unit] */
    float gdir[2]; /* gradient of ln E for turns about u, v [1/rad] */
    float var;     /* variance of E's luminance over its square; negative: not
                    * known: the place keeps E, and is no neighbour of others */
    float reach;   /* distance within which E is about linear */
    float bend;    /* expected E'' / E, a mean over directions [1/unit^2] */
};

/* The smoothed value of a place; fields as of struct rad_smooth_place. */
struct rad_smooth_value {
    float E[3], gpos[2], var;
    float least; /* extrapolations are not below this part of E; 0: no bound */
};

/* Callbacks for n places, by number; are_parted(): does something stand between
 * two places? */
struct rad_smooth_source {
    const void *arg;
    uint32_t n;                                          /* below 2^30 */
    const double *(*point)(const void *arg, uint32_t i); /* p of place i */
    void (*place)(const void *arg, uint32_t i, struct rad_smooth_place *place);
    bool (*are_parted)(const void *arg, const struct rad_smooth_place *a,
                       const struct rad_smooth_place *b);
};

struct rad_smooth;

/* *source is copied; what source->arg points to must not change until
 * rad_smooth_free().  NULL: out of memory. */
struct rad_smooth *rad_smooth_new(const struct rad_smooth_source *source);
void rad_smooth_free(struct rad_smooth *s);

/* Set *v to the value at place i < n. */
void rad_smooth_at(struct rad_smooth *s, uint32_t i,
                   struct rad_smooth_value *v);

/* Set *v to the value at a place that is not among the n. */
void rad_smooth_beside(const struct rad_smooth *s,
                       const struct rad_smooth_place *at,
                       struct rad_smooth_value *v);

/* The memory that s takes [bytes]. */
size_t rad_smooth_bytes(const struct rad_smooth *s);

#endif
