/* asks.h - what rays and light sources ask of the rooms above theirs
 *
 * Rays meet materials, and materials send rays: who stands below the other?
 * Rays do, and these are the questions that they, and the light sources beside
 * them, have for materials of certain families, and rays for light sources.
 * Each is answered in the file of its name: rad_mist_veil() in shade/mist.c.
 * Thread: any; they write to ctx and *r alone. */
#ifndef RAD_TRACE_ASKS_H
#define RAD_TRACE_ASKS_H

#include "trace/material.h"

/* --- of the table of families (shade/families.c) --- */

/* The row of a modifier's type; NULL: it is not supported. */
const struct rad_shader *rad_families_shader(enum rad_otype type);

/* --- of light sources (light/direct/source.c) --- */

/* Did a ray that left the scene meet a distant source?  Sets r->far_source and
 * the shading fields (infinitely far, facing the ray) and returns the source's
 * modifier, or RAD_VOID.  A ray aimed at a source (r->source) meets that one
 * alone.  What -dv hides, and what must not be counted twice, is for the
 * emitting material to say. */
int32_t rad_source_behind(struct rad_ctx *ctx, struct rad_ray *r);

/* A shadow ray aims at a source, or at the image of one in a mirror (see
 * virtual.h): how many are there together?  The sources come first. */
int32_t rad_sources_targets(const struct rad_sources *s);

/* --- of materials, in the order of their files --- */

/* Is the surface that r has met, one that antimatter names (job->cut), cut
 * away?  Notes it in r->kind. */
bool rad_antimatter_hides(const struct rad_ctx *ctx, struct rad_ray *r);

/* Shade the hit as a Lambertian surface of reflectance pi, whose radiance is
 * the irradiance.  Always true. */
bool rad_normal_irradiance(struct rad_ctx *ctx, struct rad_ray *r);

/* What r's way from its origin to its hit does to r->L.  r->medium is not
 * NULL. */
void rad_mist_participate(struct rad_ctx *ctx, struct rad_ray *r);

/* What *line, found along the span of a shadow ray from r's hit, leaves of the
 * light from its last entry: by r's medium and by the mists whose boundaries
 * the others are.  False: something else is there, and nothing done. */
bool rad_mist_veils(struct rad_ctx *ctx, const struct rad_ray *r,
                    const struct rad_span *span, const struct rad_line *line,
                    struct rad_rgb *T);

/* The same of r's medium alone, for a shadow ray of length t. */
struct rad_rgb rad_mist_veil(const struct rad_ctx *ctx, const struct rad_ray *r,
                             double t);

/* What glass without a pattern or texture lets pass, where it is hit in
 * direction dir and both its sides are there.  False: it is none. */
bool rad_glass_plain(const struct rad_job *job, const struct rad_hit *hit,
                     const double dir[3], struct rad_rgb *T);

/* Is obj's material a mirror, with no pattern or texture?  Its colour. */
bool rad_mirror_plain(const struct rad_job *job, int32_t obj,
                      struct rad_rgb *color);

/* How many directions the material has, 1 or 2. */
int rad_prism_ways(const struct rad_material *mat);

/* The direction, of any length, in which way number `way` sends r on from its
 * hit; false: none that brings any light. */
bool rad_prism_way(struct rad_ctx *ctx, const struct rad_material *mat,
                   const struct rad_ray *r, int way, double dir[3]);

#endif
