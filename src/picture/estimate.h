/* estimate.h - what a part of a picture will cost, from a few of its pixels
 *
 * Random pixels of the part are traced, and their rays and tests of
 * intersection counted.  Which pixels is a function of seed, frame and part
 * alone, so that whoever estimates it traces the same ones.  They are distinct,
 * and pixels are pure (frame.h): what was traced is worth keeping.
 * Thread: any, each with a context of its own. */
#ifndef RAD_PICTURE_ESTIMATE_H
#define RAD_PICTURE_ESTIMATE_H

#include "picture/frame.h"

struct rad_estimate {
    uint64_t rays;  /* of all kinds */
    uint64_t tests; /* of intersection */
};

/* A pixel that was traced with a ray, as rad_frame_pixel() gave it. */
struct rad_sampled {
    int x, y; /* in the picture */
    struct rad_pixel pixel;
};

/* The i-th pixel of the part, i below width * height, in a random order that
 * has each of them once. */
void rad_estimate_pixel(uint64_t seed, uint32_t frame,
                        const struct rad_window *part, uint32_t i, int *x,
                        int *y);

/* Trace pixels `first` to first + n - 1 of that order, as far as the part has
 * them, and add what they cost.  The part must lie in the frame.  out has room
 * for n; it gets those that the view shows.  Returns their number.
 * They are fewer where *stop is set meanwhile; NULL: it is not. */
size_t rad_estimate_trace(const struct rad_frame *f, struct rad_ctx *ctx,
                          const struct rad_window *part, uint32_t first,
                          uint32_t n, const _Atomic bool *stop,
                          struct rad_estimate *cost, struct rad_sampled *out);

/* Sort pixels by their rows, then columns. */
void rad_estimate_sort(struct rad_sampled *v, size_t n);

#endif
