/* recheck.h - a tile of a check pass: how far off would a picture be?
 *
 * The cache is frozen.  At some places all over the picture indirect light is
 * sampled afresh, and compared with what the cache says of it; a small window
 * is sampled as a picture's would be, and compared with all its pixels traced
 * by other random numbers.  Each is done twice, independently: the product of
 * both differences is the square of the error, on average.
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
