/* way.h - the way of a shadow ray, stretch by stretch (inside light/direct
 * only)
 *
 * A straight stretch leads from a lit point to a source, or to the mirror that
 * shows an image of it; the next stretch leads on from that mirror.  Where each
 * mirror and pane has one colour, and there is no mist, the light of the whole
 * way is the source's times these colours: so no rays are made for it.
 * Thread: any; ctx is the thread's. */
#ifndef RAD_LIGHT_WAY_H
#define RAD_LIGHT_WAY_H

#include "light/direct/sources.h"

/* Aim *span from a hit at a source, or at the mirror that shows an image, and
 * end the span short of that source or mirror: a surface on which a lamp is
 * mounted, in the lamp's plane, must not shade the lamp.  *hit gets where the
 * source or mirror is met, unless the source is distant.  False: the source or
 * mirror is missed. */
bool rad_way_aim(struct rad_ctx *ctx, const struct rad_hit *from,
                 int32_t source, const double dir[3], struct rad_span *span,
                 struct rad_hit *hit);

/* If `source` is an image, is the hit before its mirror?  Always true of a real
 * source.  (A ray from behind a prism could pass the image's place and then
 * meet the prism.) */
bool rad_way_faces(const struct rad_sources *s, int32_t source,
                   const struct rad_hit *at);

/* A ray towards image v, in direction dir, has met its mirror at hit.  Do the
 * reflections from there lead to the source?  Surfaces in the way are ignored.
 */
bool rad_way_leads(struct rad_ctx *ctx, const struct rad_virtual *v,
                   const double dir[3], const struct rad_hit *hit);

/* Do the reflections from hit lead to the source of v, as in rad_way_leads(),
 * and is that way clear?  CLEAR: there are at most plain panes, and *T is
 * multiplied by their colours; BLOCKED: no light comes; VEILED: only rays can
 * tell, and none has been counted. */
enum rad_sight rad_way_clear(struct rad_ctx *ctx, const struct rad_virtual *v,
                             const double dir[3], const struct rad_hit *hit,
                             struct rad_rgb *T);

/* rad_geom_sight() found no opaque surface on a span towards a source or image,
 * but transparent ones: the first at hit, all on line.  Is the way clear, on
 * this span and behind the mirrors?  Returns and sets *T as rad_way_clear().
 */
enum rad_sight rad_way_through(struct rad_ctx *ctx, int32_t source,
                               const struct rad_span *span,
                               const struct rad_hit *hit,
                               const struct rad_line *line, struct rad_rgb *T);

#endif
