/* frame.h - one picture of a job: pixels as a function, and windows of it
 *
 * A frame ties a compiled scene to a view and a resolution, or to sensor
 * points.  A pixel's value depends on job, view, frame number and (x, y) alone
 * (with the ambient cache off or frozen).  Rows count from the top; L is
 * radiance.
 * Thread: a frame is read-only once set up; any thread may render any window of
 * it with a context of its own. */
#ifndef RAD_PICTURE_FRAME_H
#define RAD_PICTURE_FRAME_H

#include "picture/paint.h"
#include "picture/quincunx.h"
#include "picture/view.h"
#include "points/points.h"
#include "trace/ray.h"

struct rad_frame {
    const struct rad_job *job;
    struct rad_view view;   /* set up */
    const struct rad_points *points; /* [borrowed] instead of a view; or NULL */
    int width, height;      /* what rad_view_resolution() made of -x -y -pa */
    double pixaspect;       /* height / width of a pixel, for the header */
    uint32_t number;        /* 0 for a still, 1.. in an animation */
    uint64_t key;           /* of the pixels' random numbers */
    uint64_t stamp;         /* identifies its rays in ctx->aim; not 0 */
    bool depth;             /* -z wanted */
    int oversample; /* pixels a side of each pixel of the picture that is
                     * written; 0 counts as 1 */
    bool moving;            /* -pm: blurred by motion from `before` */
    struct rad_view before; /* the last frame's view, set up */
    struct rad_paint paint; /* small sources to paint; none with -dv- */
};

struct rad_window {
    int x, y, width, height; /* in pixels, y from the top */
};

/* The size of the picture of a view (set up) under the parameters, and its
 * pixel aspect ratio; RAD_EUSAGE if it has no pixels. */
int rad_frame_size(const struct rad_params *p, const struct rad_view *view,
                   int *width, int *height, double *pixaspect,
                   struct rad_error *err);

/* Set *f up from the job's parameters and a view, which need not be set up.
 * RAD_EUSAGE for an impossible view or no pixels, RAD_ENOMEM. */
int rad_frame_init(struct rad_frame *f, const struct rad_job *job,
                   const struct rad_view *view, uint32_t number, bool depth,
                   struct rad_error *err);
void rad_frame_release(struct rad_frame *f);

/* f->oversample, from 1. */
int rad_frame_oversample(const struct rad_frame *f);

/* Set *f up from sensor points, which must outlive *f.  A pixel has the
 * radiance and distance that rtrace gives for its point. */
void rad_frame_of_points(struct rad_frame *f, const struct rad_job *job,
                         const struct rad_points *points);

/* Set up the sampler of a window, which for strict partitions is the whole
 * frame; trace and arg are left alone. */
void rad_frame_sampler(const struct rad_frame *f, const struct rad_window *w,
                       struct rad_quincunx *q);

/* With -pm blur the frame by the motion from `before`, the last frame's view:
 * half of the blur lies toward that view, half beyond the frame's own.  Small
 * sources are then not painted.  Without -pm nothing happens.  RAD_EUSAGE for
 * an impossible view. */
int rad_frame_move(struct rad_frame *f, const struct rad_view *before,
                   struct rad_error *err);

/* Trace the primary ray of a pixel into *r, without rad_frame_pixel()'s further
 * samples and counts; false: the view has no ray there. */
bool rad_frame_look(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                    int y, struct rad_ray *r);

/* Set up the primary ray of a pixel without tracing it.  If the frame is of
 * points on surfaces, *met is set and the ray has met the pixel's point.
 * False: the view has no ray there. */
bool rad_frame_start(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                     int y, struct rad_ray *r, bool *met);

/* Trace one pixel and count a primary ray.  False, with a black pixel and no
 * ray counted, where the view shows nothing.  If radiance that is not finite or
 * is negative turned up on the way, the pixel is counted in nan_pixels; nan_x
 * and nan_y keep the first such pixel. */
bool rad_frame_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                     int y, struct rad_pixel *out);

/* Paint the small sources into pixels x0 to x1 - 1 of row y, after these were
 * sampled; row[0] is the pixel of column x0.  With -dv- nothing is painted. */
void rad_frame_paint_row(const struct rad_frame *f, struct rad_ctx *ctx, int x0,
                         int x1, int y, struct rad_pixel *row);

/* Render a window by itself, with edges and densities of its own; with -dv
 * small sources are painted.  rows[k] has room for the window's k-th row from
 * the top.  Returns 0, RAD_ENOMEM, or RAD_EUSAGE for a window outside the
 * picture. */
int rad_frame_window(const struct rad_frame *f, struct rad_ctx *ctx,
                     const struct rad_window *w,
                     struct rad_pixel *const rows[]);

#endif
