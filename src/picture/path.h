/* path.h - random paths that leave pixels and bounce about, found by
 * intersection alone
 *
 * Paths end where rays of hemispheres do.  So they show where deep ambient
 * records will be asked for, before any ray asks (passes/passes.h).
 * Thread: any, each with a context of its own. */
#ifndef RAD_PICTURE_PATH_H
#define RAD_PICTURE_PATH_H

#include "light/indirect/ambient.h"
#include "picture/frame.h"

/* The branch of the rays of paths; hemispheres have fewer rays than this. */
#define RAD_PATH_BRANCH (RAD_BRANCH_RAMBIENT | 0xfffffe)

/* Start path n of a frame: r, with this key, meets the surface that a pixel
 * shows behind panes; false: it meets none.  The pixels of the paths are a
 * sequence of which any first part covers the picture evenly (Roberts 2018: by
 * the root of x^3 = x + 1); `spread` chooses where the sequence begins. */
bool rad_path_begin(const struct rad_frame *f, struct rad_ctx *ctx,
                    uint64_t spread, uint64_t n, uint64_t key,
                    struct rad_ray *r);

/* Start r off the hit of `parent`, as a ray of the hemisphere there.  Bounce
 * number k of the path with this key draws the key's numbers 2 k and 2 k + 1.
 * False: no ray goes on from there. */
bool rad_path_bounce(struct rad_ctx *ctx, const struct rad_ray *parent,
                     uint64_t key, int k, struct rad_ray *r);

/* Find what r meets, without shading it; false: nothing. */
bool rad_path_meet(struct rad_ctx *ctx, struct rad_ray *r);

/* The place that r has met after `level` bounces, as the ambient cache would be
 * asked for it: with the geometric normal, on the side that was hit. */
void rad_path_place(const struct rad_ray *r, int level,
                    struct rad_ambplace *at);

#endif
