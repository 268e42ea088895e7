/* path.h - random paths that leave pixels and bounce about, by intersection
 * alone
 *
 * They end where rays of hemispheres do: whoever wants deep ambient records
 * before rays ask for them looks there (passes/passes.h).
 * Thread: any, each with a context of its own. */
#ifndef RAD_PICTURE_PATH_H
#define RAD_PICTURE_PATH_H

#include "light/indirect/ambient.h"
#include "picture/frame.h"

/* Of the rays of paths; no hemisphere has so many. */
#define RAD_PATH_BRANCH (RAD_BRANCH_RAMBIENT | 0xfffffe)

/* What is seen at the start of path n of a frame, behind panes: r, whose key is
 * `key`, has met it.  Pixels are those of a sequence each of whose beginnings
 * is spread evenly over the picture (Roberts 2018: by the root of x^3 = x + 1),
 * from where `spread` says.  False: there is nothing. */
bool rad_path_begin(const struct rad_frame *f, struct rad_ctx *ctx,
                    uint64_t spread, uint64_t n, uint64_t key,
                    struct rad_ray *r);

/* Start r off the hit of `parent`, as a ray of its hemisphere: bounce number k
 * of the path with that key draws numbers 2 k and 2 k + 1 of it.  False: no ray
 * goes on from there. */
bool rad_path_bounce(struct rad_ctx *ctx, const struct rad_ray *parent,
                     uint64_t key, int k, struct rad_ray *r);

/* Find what r meets, and shade nothing; false: nothing. */
bool rad_path_meet(struct rad_ctx *ctx, struct rad_ray *r);

/* What r has met after so many bounces, on the side that was hit and as its
 * geometry is, as the cache would be asked for it. */
void rad_path_place(const struct rad_ray *r, int level,
                    struct rad_ambplace *at);

#endif
