/* source.h - light sources and the direct light they give
 *
 * Every surface under light, illum, glow (of non-zero radius) or spotlight is
 * a source: a distant one (`source`), or a surface that is sampled by area.
 * -ds divides a source until each part is small against its distance, -dj
 * jitters the sample within its part, -dt and -dc decide which shadow rays are
 * worth tracing.
 * Selective testing must not make one pixel depend on another: where Radiance
 * estimates untested sources from hit counts so far, we use figures that are
 * the same everywhere (source.c says which).
 * Thread: the list is made by one, and read by all from then on.
 * Sources: Ward 1991, Adaptive shadow testing for ray tracing;
 * rpict(1) on -dj -ds -dt -dc. */
#ifndef RAD_LIGHT_SOURCE_H
#define RAD_LIGHT_SOURCE_H

#include "trace/asks.h"

struct rad_sources; /* [fixed] once rad_sources_new() returns */

/* Find and prepare the sources of a compiled scene (geometry and materials are
 * there).  NULL and *err on failure; no sources is not a failure. */
struct rad_sources *rad_sources_new(struct rad_job *job, struct rad_error *err);

/* BRDF of a material toward a light sample: *coef gets radiance per radiance
 * of the source: BRDF * |cos| * omega, black where it does not reflect.
 *   data   the caller's (material and hit at hand)
 *   ldir   unit direction to the sample
 *   omega  solid angle of the sample [sr] */
typedef void rad_brdf_fn(struct rad_rgb *coef, void *data, const double ldir[3],
                         double omega);

/* Add the direct light at r's hit to r->L.
 *   through  brdf may be other than black for light from behind the surface;
 *            false lets sources there be skipped early */
void rad_direct(struct rad_ctx *ctx, struct rad_ray *r, rad_brdf_fn *brdf,
                void *data, bool through);

/* May anything of source or image i reach a place?  Decided without looking at
 * the source's parts, or at what is in the way. */
bool rad_source_reaches(const struct rad_sources *s, int32_t i,
                        const double p[3]);

/* Add to r->L what comes from one source (or image of one), undivided: for a
 * place in mid-air, which r->hit is made to look like and
 * rad_source_reaches() is true of. */
void rad_direct_from(struct rad_ctx *ctx, struct rad_ray *r, int32_t source,
                     rad_brdf_fn *brdf, void *data);

/* The object that is source number i, or the mirror that shows image i. */
int32_t rad_source_object(const struct rad_sources *s, int32_t i);

/* What image i shows: a source, or another image; -1: i is no image. */
int32_t rad_source_shown(const struct rad_sources *s, int32_t i);

/* By which way of a prism image i is shown; 0 for others. */
int32_t rad_source_way(const struct rad_sources *s, int32_t i);

/* The unit direction from p to the centre of source or image i; zero where p is
 * the centre. */
void rad_source_toward(const struct rad_sources *s, int32_t i,
                       const double p[3], double dir[3]);

/* The radiance that a shadow ray brings from where it is aimed: r->source, in
 * direction r->dir from its parent's hit.  With RAD_RAY_UNTESTED in r->path
 * whatever is in the way is ignored. */
void rad_source_aimed(struct rad_ctx *ctx, struct rad_ray *r);

/* Where a source is and how it extends, for painting those that look smaller
 * than a sample (see picture/paint.h); of an image, the source that it shows.
 * The axes are those of what rpict takes it for (shape.c); of a tube the first
 * is half of it. */
struct rad_source_shape {
    int32_t obj;
    bool distant; /* centre is a unit direction; axes are tangents [rad] */
    bool flat;
    double centre[3];
    double axis[3][3]; /* half-axes; of flat ones the third is the unit
                        * normal, of distant ones zero */
    double radius;     /* of the bounding sphere about centre */
};
void rad_source_shape(const struct rad_sources *s, int32_t i,
                      struct rad_source_shape *shape);

/* From where the source that image i shows is seen as the image is from p; p
 * itself where i is no image. */
void rad_source_seen_from(const struct rad_sources *s, int32_t i,
                          const double p[3], double there[3]);

/* Where a point of the source that i is, or shows, appears: a direction of any
 * length where it is distant. */
void rad_source_appears(const struct rad_sources *s, int32_t i,
                        const double point[3], double at[3]);

#endif
