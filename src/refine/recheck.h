/* recheck.h - a tile of a check pass: how far off would a picture be?
 *
 * The cache is frozen.  A tile samples small windows as the picture's pixels
 * would be, and renders again some areas of these windows and some places all
 * over the picture (picture/doubt.h).
 * Thread: see rad_passes_make(). */
#ifndef RAD_REFINE_RECHECK_H
#define RAD_REFINE_RECHECK_H

#include "passes/passes.h"
#include "refine/refine.h"

/* Make a tile of the check pass that p is at: a function of the job, as all
 * tiles are.  Its rays count as those of passes do.  False: within a pixel of
 * *stop, or memory is out. */
bool rad_refine_make(const struct rad_passes *p, struct rad_ctx *ctx,
                     uint32_t tile, const _Atomic bool *stop,
                     struct rad_refine_sums *out);

#endif
