/* asks.h - functions of upper rooms that rays and light sources call
 *
 * Materials spawn rays, and rays call materials.  The room of rays is the lower
 * one, so here are declared the functions of other rooms that rays call: of
 * materials of certain families and of light sources; and those of materials
 * that light sources call.  Each is defined in the file of its name:
 * rad_mist_veil() in shade/mist.c.
 * Thread: any; they write to ctx and *r alone. */
#ifndef RAD_TRACE_ASKS_H
#define RAD_TRACE_ASKS_H

#include "trace/material.h"

/* --- of the table of families (shade/families.c) --- */

/* The row of a modifier's type in the table; NULL: it is not supported. */
const struct rad_shader *rad_families_shader(enum rad_otype type);

/* --- of light sources (light/direct/source.c) --- */

/* Does a ray that meets no surface meet a distant source?  If so, sets
 * r->far_source and the shading fields (infinitely far, facing the ray) and
 * returns the source's modifier; else RAD_VOID.  A ray that is aimed at a
 * source (r->source) meets that source alone.  The emitting material decides
 * what -dv hides, and what direct light counts already. */
int32_t rad_source_behind(struct rad_ctx *ctx, struct rad_ray *r);

/* r is aimed at a source or mirror and has met a surface: let it meet what it
 * is aimed at, if that lies in the surface, as a lamp in its ceiling does. */
void rad_source_in_plane(struct rad_ctx *ctx, struct rad_ray *r);

/* The number of targets of shadow rays: sources, then images of sources in
 * mirrors (light/direct/virtual.h). */
int32_t rad_sources_targets(const struct rad_sources *s);

/* --- of materials, in the order of their files --- */

/* Is the surface that r has met cut away?  Antimatter names its modifier
 * (job->cut).  Notes the answer in r->kind. */
bool rad_antimatter_hides(const struct rad_ctx *ctx, struct rad_ray *r);

/* Shade the hit as a diffuse surface of reflectance pi, whose radiance is the
 * irradiance.  Always true. */
bool rad_normal_irradiance(struct rad_ctx *ctx, struct rad_ray *r);

/* Let r->medium, which is not NULL, dim r->L on the way from r's origin to its
 * hit, and add the light that it scatters. */
void rad_mist_participate(struct rad_ctx *ctx, struct rad_ray *r);

/* Set *T to the transmittance of r's medium and of mists on the way of a shadow
 * ray from r's hit, along the span.  *line is what the ray meets: boundaries of
 * mists, and the source as the last entry.  False: it meets something else, or
 * started in a mist; then *T is of no use. */
bool rad_mist_veils(struct rad_ctx *ctx, const struct rad_ray *r,
                    const struct rad_span *span, const struct rad_line *line,
                    struct rad_rgb *T);

/* The transmittance of a medium (NULL: one that does not scatter), whose
 * extinction is ext, for a shadow ray of length t. */
struct rad_rgb rad_mist_veil(const struct rad_ctx *ctx,
                             const struct rad_medium *m, struct rad_rgb ext,
                             double t);

/* Set *T to the transmittance of a pane of glass without pattern or texture,
 * which is hit in direction dir and has both its sides.  False: the surface is
 * no such pane. */
bool rad_glass_plain(const struct rad_job *job, const struct rad_hit *hit,
                     const double dir[3], struct rad_rgb *T);

/* Is obj's material a mirror without pattern or texture?  Sets *color. */
bool rad_mirror_plain(const struct rad_job *job, int32_t obj,
                      struct rad_rgb *color);

/* The number of ways of a prism, directions into which it sends a ray: 1 or 2.
 */
int rad_prism_ways(const struct rad_material *mat);

/* Set dir, of any length, to the direction into which way number `way` of a
 * prism sends r on from its hit; false: that way brings no light. */
bool rad_prism_way(struct rad_ctx *ctx, const struct rad_material *mat,
                   const struct rad_ray *r, int way, double dir[3]);

#endif
