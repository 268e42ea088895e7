/* way.h - the way of a shadow ray, stretch by stretch (inside light/direct
 * only)
 *
 * From a place that is lit a straight stretch leads to a source; or to the
 * mirror that shows an image of one, and the next from there.  Where mirrors
 * and panes have one colour, and all around is clear air, nothing but products
 * of these colours comes of the whole way: so no rays are made for it.
 * Thread: any; ctx is the thread's. */
#ifndef RAD_LIGHT_WAY_H
#define RAD_LIGHT_WAY_H

#include "light/direct/sources.h"

/* Aim a span from a hit at a source or image, and end it short of that, so that
 * what a lamp is mounted on, in the same plane, does not shade it.  *hit gets
 * where it is met, unless it is distant.  False: the source is missed. */
bool rad_way_aim(struct rad_ctx *ctx, const struct rad_hit *from,
                 int32_t source, const double dir[3], struct rad_span *span,
                 struct rad_hit *hit);

/* Is a hit before the mirror, if the source is an image?  Behind a prism a ray
 * to its image could pass that and meet the prism then. */
bool rad_way_faces(const struct rad_sources *s, int32_t source,
                   const struct rad_hit *at);

/* The image v of a source is looked at in direction dir, and its mirror met at
 * hit; do the mirrors behind lead to the source from there?  Nothing is asked
 * of what may be in the way. */
bool rad_way_leads(struct rad_ctx *ctx, const struct rad_virtual *v,
                   const double dir[3], const struct rad_hit *hit);

/* The same, and is that way clear?  CLEAR: but for plain panes, by which *T, a
 * factor for what comes, is dimmed; BLOCKED: no light comes; VEILED: it takes
 * rays to say, and none has been counted. */
enum rad_sight rad_way_clear(struct rad_ctx *ctx, const struct rad_virtual *v,
                             const double dir[3], const struct rad_hit *hit,
                             struct rad_rgb *T);

/* A span towards a source or image, with nothing opaque on it, meets what hit
 * and line say (rad_geom_sight()), and that is not the target.  Is the way
 * clear, first there and then behind the mirrors?  As rad_way_clear(). */
enum rad_sight rad_way_through(struct rad_ctx *ctx, int32_t source,
                               const struct rad_span *span,
                               const struct rad_hit *hit,
                               const struct rad_line *line, struct rad_rgb *T);

#endif
