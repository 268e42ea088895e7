/* paint.h - light sources that are too small in the picture for the sampler
 *
 * The sampler may miss a source that is narrower than -ps pixels.  With -dv+
 * such sources are painted after a bar is filled: each pixel gets the radiance
 * of a ray to the source for the share of its area that the source covers.
 * As in rpict, a source is painted as a simple shape: a ball as a box.  Illums
 * are not painted, nor sources that are not wholly in view.  Images of sources
 * in mirrors and prisms are painted like sources, even where the mirror looks
 * like another material to the eye.  A painted pixel depends on the pixel and
 * the picture alone, not on the bar or window that it is painted in; it does
 * depend on whether the picture has depths (-z), as in rpict: see cover() in
 * paint.c.
 * Source: rpict(1) on -dv and -ps. */
#ifndef RAD_PICTURE_PAINT_H
#define RAD_PICTURE_PAINT_H

#include "picture/quincunx.h"
#include "picture/view.h"
#include "trace/ray.h"

/* The most corners of an outline: those of a box. */
enum { RAD_PAINT_CORNERS = 6 };

/* A source's outline: a convex polygon in picture positions (0..1). */
struct rad_paint_source {
    int32_t source;
    int ncorners;
    double corner[RAD_PAINT_CORNERS][2];
};

struct rad_paint {
    struct rad_paint_source *list; /* in the scene's order */
    int32_t n;
};

/* Find the sources of a job that need painting in a picture of width columns.
 * 0 or RAD_ENOMEM. */
int rad_paint_init(struct rad_paint *p, const struct rad_job *job,
                   const struct rad_view *v, int width, struct rad_error *err);
void rad_paint_release(struct rad_paint *p);

/* The picture to paint in. */
struct rad_canvas {
    const struct rad_view *view;
    int width, height;
    uint64_t seed;
    uint32_t frame;
    bool depth;
};

/* Paint pixels x0 to x1 - 1 of row y (from the top) of the picture; row[0] is
 * the pixel of column x0.  Rays are counted in paint_rays. */
void rad_paint_row(const struct rad_paint *p, const struct rad_canvas *canvas,
                   struct rad_ctx *ctx, int x0, int x1, int y,
                   struct rad_pixel *row);

/* The share of pixel (x, y), y from the bottom, that a source covers; 0: none.
 * centre gets the mean of the covered part's corners. */
double rad_paint_coverage(const struct rad_paint_source *s,
                          const struct rad_canvas *canvas, int x, int y,
                          double centre[2]);

#endif
