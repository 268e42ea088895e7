/* frame.h - one picture of a job: pixels as a function, and windows of it
 *
 * Ties a compiled scene to a view and a resolution.  A pixel's value depends
 * on job, view, frame number and (x, y) alone (with the ambient cache off or
 * frozen).
 * Rows count from the top; L is radiance. */
#ifndef RAD_PICTURE_FRAME_H
#define RAD_PICTURE_FRAME_H

#include "picture/quincunx.h"
#include "picture/view.h"
#include "shade/ray.h"

struct rad_frame {
    const struct rad_job *job;
    struct rad_view view;  /* set up */
    int width, height;     /* what rad_view_resolution() made of -x -y -pa */
    uint32_t number;       /* 0 for a still, 1.. in an animation */
    bool depth;            /* -z wanted */
};

struct rad_window {
    int x, y, width, height; /* in pixels, y from the top */
};

/* Set *f up from the job's parameters and a view; RAD_EUSAGE as rpict. */
int rad_frame_init(struct rad_frame *f, const struct rad_job *job,
                   const struct rad_view *view, uint32_t number, bool depth,
                   struct rad_error *err);

/* Trace one pixel and count it as a primary ray.  A value that is not finite
 * or negative becomes black and is counted. */
void rad_frame_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                     int y, struct rad_pixel *out);

/* Render a window by itself (its own edges and densities), small sources
 * painted with -dv.  rows[k] points at the k-th row of the window (from the
 * top), window.width pixels each.  stop (may be NULL) is asked between bars:
 * true ends early.  Returns 0, or RAD_ENOMEM, or RAD_ETEMPFAIL when stopped. */
int rad_frame_window(const struct rad_frame *f, struct rad_ctx *ctx,
                     const struct rad_window *w, struct rad_pixel *const rows[],
                     bool (*stop)(void *arg, int rows_done), void *arg);

#endif
