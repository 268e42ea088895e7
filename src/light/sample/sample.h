/* sample.h - where on a light source to look from a given point
 *
 * A source is cut into patches until each is small against its distance (-ds),
 * and each patch gives one sample: the direction in which a shadow ray tests
 * it and the solid angle that it stands for.  A sample counts by the area of
 * its patch, so each part of the source has its due weight.  There are no more
 * patches than rpict makes.
 *
 * Without division (-ds 0) a sample is the source's middle, with the solid
 * angle of a small patch there, as in rpict.  With division and without jitter
 * a sample has the direction and size of its patch's flux: exact (contour.h),
 * or, for distant patches and parallelograms, expanded to second order about
 * the centroid.  That lowers the error of a patch that is a fifth as wide as
 * its distance from 1 % to under 0.1 %.  With jitter (-dj) the sample is a
 * random point of the patch, and its solid angle follows from the density of
 * such points, so that the mean over many samples is right.
 *
 * omega is meant for irradiance: a patch adds L * omega * cos.
 * Thread: rad_light_samples() reads the source and writes nothing shared.  */
#ifndef RAD_LIGHT_SAMPLE_H
#define RAD_LIGHT_SAMPLE_H

#include "base/color.h"
#include "light/sample/spot.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    RAD_LIGHT_DISTANT = 1, /* at infinity: centre is its direction */
    RAD_LIGHT_SKIP = 2,    /* seen, but gives no direct light */
    RAD_LIGHT_NEAR = 4,    /* a glow: lights only points within `reach` */
    RAD_LIGHT_SPOT = 8,    /* a spotlight */
    RAD_LIGHT_FLAT = 16,   /* one-sided, with a normal */
    RAD_LIGHT_PASSES = 32, /* an illum without alternate: rays pass it */
    RAD_LIGHT_PLAIN = 64   /* has the same radiance L everywhere */
};

/* First and second moments of a uniform patch: E[(p - c)(p - c)^T] is
 * a a^T + b b^T. */
struct rad_moments {
    double c[3], a[3], b[3];
    double aim[3]; /* a point of the patch: c, if that lies on it */
    double area;   /* [scene units^2]; of a cylinder, diameter x length */
};

struct rad_polytree;

struct rad_source {
    int32_t obj;
    unsigned flags;       /* RAD_LIGHT_* */
    enum rad_otype shape; /* POLYGON RING SPHERE CYLINDER or SOURCE */
    double centre[3];     /* of a distant source: unit direction to it */
    double axis[3][3];    /* as in struct rad_source_shape */
    double normal[3];     /* of flat sources, unit */
    double radius;        /* of the bounding sphere; distant: the chord from
                           * the middle to the edge, size = pi radius^2 */
    double r0, r1;        /* of ring; r1 of sphere and cylinder */
    double size;          /* area as in rad_moments; sphere: pi r^2; distant:
                           * solid angle [sr] */
    double reach;         /* of a glow [scene units] */
    struct rad_spot spot;
    double apex;             /* of a spotlight: a cone with its angle and axis,
                              * whose tip lies this far behind the centre, holds
                              * all points that the source lights; INFINITY:
                              * there is no such cone */
    double cone2;            /* squared cosine of the cone's half angle, less
                              * rounding */
    struct rad_rgb L;        /* radiance [W/sr/m^2] before patterns */
    struct rad_moments root; /* of the whole source; not of spheres and distant
                              * sources */
    const struct rad_polytree *tree; /* polygons that are no parallelogram */
};

/* Set src->apex and cone2 of a spotlight whose shape and spot are set. */
void rad_light_set_apex(struct rad_source *src);

/* Set the shape of *src from a surface of the scene.  Triangulations go to
 * arena.  Returns 0, or 1 if the surface has no area and so gives no light, or
 * RAD_EDATA (a surface that cannot be a light source) or RAD_ENOMEM. */
int rad_light_shape(struct rad_source *src, const struct rad_object *o,
                    struct rad_arena *arena);

struct rad_light_sample {
    double aim[3]; /* unit direction of the shadow ray */
    double dist;   /* to the point aimed at; INFINITY if distant */
    double dir[3]; /* unit direction of the mean flux, for the BRDF */
    double omega;  /* [sr] */
};

/* A point that sees a source, and how samples are made for it. */
struct rad_light_view {
    double p[3];      /* the point */
    double sizerat;   /* -ds over the ray's weight; 0: no division */
    double jitter;    /* -dj */
    uint64_t key;     /* of the random numbers */
    const double *up; /* unit normal at p, if a part of the source may lie below
                       * its horizon and is to be left out; else NULL */
};

typedef void rad_light_fn(void *arg, const struct rad_light_sample *s);

/* May light of *src reach p, if nothing is in the way?  Not behind a flat
 * source, inside a cylinder, outside a spotlight's cone, or beyond a glow's
 * reach. */
bool rad_light_reaches(const struct rad_source *src, const double p[3]);

/* Call fn as rad_light_samples() does, where rad_light_reaches() is known to be
 * true. */
void rad_light_samples_within(const struct rad_source *src,
                              const struct rad_light_view *view,
                              rad_light_fn *fn, void *arg);

/* Call fn with each sample of *src, seen from *view, in a fixed order; with
 * none where the source's light does not reach. */
void rad_light_samples(const struct rad_source *src,
                       const struct rad_light_view *view, rad_light_fn *fn,
                       void *arg);

#endif
