/* source.h - light sources and the direct light they give
 *
 * Every surface under light, illum, glow (of positive radius) or spotlight is
 * a source: a distant one (`source`), or a surface that is sampled by area.
 * -ds divides a source until each part is small against its distance, -dj
 * jitters the sample within its part, -dt and -dc decide which shadow rays are
 * worth tracing.
 * Selective testing must not make one pixel depend on another: Radiance
 * estimates the light of untested sources from hit counts of earlier pixels,
 * here it is estimated from the sources that the point itself sees (shadow.c).
 * Sources are numbered first, their images in mirrors after them (virtual.h);
 * "source or image i" is a number of either.
 * Thread: one thread makes the list, all threads read it from then on.
 * Sources: Ward 1991, Adaptive shadow testing for ray tracing;
 * rpict(1) on -dj -ds -dt -dc. */
#ifndef RAD_LIGHT_SOURCE_H
#define RAD_LIGHT_SOURCE_H

#include "trace/asks.h"

struct rad_sources; /* [fixed] once rad_sources_new() returns */

/* Find and prepare the sources of a job whose geometry and materials are
 * compiled; they live in the job's arena.  NULL and *err on failure; a scene
 * without sources gets an empty list. */
struct rad_sources *rad_sources_new(struct rad_job *job, struct rad_error *err);

/* The BRDF of a material toward a light sample: *coef gets the reflected
 * radiance per radiance of the source, BRDF * |cos| * omega; black where the
 * material reflects nothing.
 *   data   the caller's: the material and the hit
 *   ldir   unit direction to the sample
 *   omega  solid angle of the sample [sr] */
typedef void rad_brdf_fn(struct rad_rgb *coef, void *data, const double ldir[3],
                         double omega);

/* Add the direct light at r's hit to r->L.
 *   through  the material passes light from behind the surface; if false,
 *            sources behind it are skipped */
void rad_direct(struct rad_ctx *ctx, struct rad_ray *r, rad_brdf_fn *brdf,
                void *data, bool through);

/* May light of source or image i reach p, if nothing is in the way?  A coarse
 * test, without the source's parts; always true of images. */
bool rad_source_reaches(const struct rad_sources *s, int32_t i,
                        const double p[3]);

/* Add to r->L the light of one source or image, undivided, at a place in the
 * air.  The caller fills in r->hit as if a surface were there, and has found
 * rad_source_reaches() true. */
void rad_direct_from(struct rad_ctx *ctx, struct rad_ray *r, int32_t source,
                     rad_brdf_fn *brdf, void *data);

/* The object that is source number i, or the mirror that shows image i. */
int32_t rad_source_object(const struct rad_sources *s, int32_t i);

/* The source, or other image, that image i shows; -1: i is no image. */
int32_t rad_source_shown(const struct rad_sources *s, int32_t i);

/* The way of the prism (shade/prism.h) that shows image i; 0 if no prism does.
 */
int32_t rad_source_way(const struct rad_sources *s, int32_t i);

/* The unit direction from p to the centre of source or image i; zero where p is
 * the centre. */
void rad_source_toward(const struct rad_sources *s, int32_t i,
                       const double p[3], double dir[3]);

/* Trace shadow ray r, from its parent's hit in direction r->dir, to source or
 * image r->source; r->L gets the radiance that it brings.  With
 * RAD_RAY_UNTESTED in r->path surfaces in the way are ignored. */
void rad_source_aimed(struct rad_ctx *ctx, struct rad_ray *r);

/* The place and shape of a source, for painting sources that look smaller than
 * a sample (picture/paint.h); of an image, the place and shape of the source
 * that the image shows.  The axes are rpict's (shape.c); the first of a
 * cylinder is half of its own axis. */
struct rad_source_shape {
    int32_t obj;
    bool distant; /* centre is a unit direction; axes are tangents [rad] */
    bool flat;
    double centre[3];
    double axis[3][3]; /* half-axes; the third of a flat source is the unit
                        * normal, of a distant source zero */
    double radius;     /* of the bounding sphere about centre */
};
void rad_source_shape(const struct rad_sources *s, int32_t i,
                      struct rad_source_shape *shape);

/* Set `there` to the point from which the source looks as its image i does from
 * p; to p if i is no image. */
void rad_source_seen_from(const struct rad_sources *s, int32_t i,
                          const double p[3], double there[3]);

/* Set `at` to the place where image i shows a point of its source; to the point
 * itself if i is no image.  If the source is distant, point and `at` are
 * directions, `at` of any length. */
void rad_source_appears(const struct rad_sources *s, int32_t i,
                        const double point[3], double at[3]);

#endif
