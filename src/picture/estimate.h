/* estimate.h - what a part of a picture will cost, from a few of its pixels
 *
 * Random pixels of the part are traced, and their rays and intersection tests
 * counted.  Which pixels is a function of seed, frame and part alone, so all
 * workers that estimate a part trace the same pixels.  The pixels are distinct.
 * A pixel is a function of its place (frame.h), so the traced values are kept.
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

/* The i-th pixel of the part, i below width * height.  The order is random and
 * has each pixel once. */
void rad_estimate_pixel(uint64_t seed, uint32_t frame,
                        const struct rad_window *part, uint32_t i, int *x,
                        int *y);

/* Pixels `first` to first + n - 1 of that order, or up to the last of the part,
 * which must lie in the frame. */
struct rad_estimate_order {
    struct rad_window part;
    uint32_t first, n;
    const _Atomic bool *stop; /* once set, pixels are left out; or NULL */
};

/* Trace them, and add their cost to *cost.  out, with room for n, gets the
 * pixels that the view shows; returns their number. */
size_t rad_estimate_trace(const struct rad_frame *f, struct rad_ctx *ctx,
                          const struct rad_estimate_order *order,
                          struct rad_estimate *cost, struct rad_sampled *out);

/* Sort pixels by their rows, then columns. */
void rad_estimate_sort(struct rad_sampled *v, size_t n);

#endif
