/* frame.h - one picture of a job: pixels as a function, and windows of it
 *
 * Ties a compiled scene to a view and a resolution, or to sensor points.  A
 * pixel's value depends on job, view, frame number and (x, y) alone (with the
 * ambient cache off or frozen). Rows count from the top; L is radiance. Thread:
 * a frame is read-only once set up; any thread may render any window of it with
 * a context of its own. */
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
    const struct rad_points *points; /* [borrowed] in its place; or NULL */
    int width, height;      /* what rad_view_resolution() made of -x -y -pa */
    double pixaspect;       /* height / width of a pixel, for the header */
    uint32_t number;        /* 0 for a still, 1.. in an animation */
    uint64_t key;           /* of its random numbers */
    uint64_t stamp;         /* tells its rays from other frames', not 0 */
    bool depth;             /* -z wanted */
    bool moving;            /* -pm: between these views */
    struct rad_view before; /* the last frame's, set up */
    struct rad_paint paint; /* sources to be painted; none with -dv- */
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

/* The same of sensor points, which must outlive it: a pixel is what rtrace
 * gives for its point, its distance included. */
void rad_frame_of_points(struct rad_frame *f, const struct rad_job *job,
                         const struct rad_points *points, uint32_t number);

/* The sampler of a window (of the whole frame: how strict partitions see it)
 * but for trace and arg, which are left alone. */
void rad_frame_sampler(const struct rad_frame *f, const struct rad_window *w,
                       struct rad_quincunx *q);

/* With -pm, blur the frame between the view of the one before and the next, as
 * if the change went on; small sources are then not painted.  Without -pm
 * nothing happens.  RAD_EUSAGE for an impossible view. */
int rad_frame_move(struct rad_frame *f, const struct rad_view *before,
                   struct rad_error *err);

/* Trace the primary ray of a pixel, where the pixel's value is not wanted;
 * false: the view has none there. */
bool rad_frame_look(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                    int y, struct rad_ray *r);

/* Start the primary ray of a pixel, which has met nothing yet; but where a
 * sensor point is a place on a surface, *met, the ray has met that.  False: the
 * view has none there. */
bool rad_frame_start(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                     int y, struct rad_ray *r, bool *met);

/* Trace one pixel and count it as a primary ray; what the view does not show
 * is black and no ray: false.  A pixel that a value touched that is not finite
 * or negative is counted in nan_pixels; nan_x and nan_y keep the first. */
bool rad_frame_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x,
                     int y, struct rad_pixel *out);

/* Paint the small sources into pixels x0 to x1-1 of row y, once they are
 * sampled; row[0] is that of column x0.  Nothing with -dv-. */
void rad_frame_paint_row(const struct rad_frame *f, struct rad_ctx *ctx, int x0,
                         int x1, int y, struct rad_pixel *row);

/* Render a window by itself (its own edges and densities), small sources
 * painted with -dv.  rows[k] points at the k-th row of the window (from the
 * top), window.width pixels each.  stop (may be NULL) is asked between bars
 * with the rows that are done from the top: true ends early.  Returns 0,
 * RAD_ENOMEM, RAD_EUSAGE for a window that is not within the picture, or
 * RAD_ETEMPFAIL when stopped. */
int rad_frame_window(const struct rad_frame *f, struct rad_ctx *ctx,
                     const struct rad_window *w, struct rad_pixel *const rows[],
                     bool (*stop)(void *arg, int rows_done), void *arg);

#endif
