/* filter.h - filtering a picture down from N by N samples a pixel
 *
 * The result is that of pfilt(1) with -1 -x /N -y /N -r .6.  A pixel is a mean
 * of the samples around it, weighted by a Gaussian of their distance with a
 * radius of .6 pixels, which is flat within a sample's own area and cut off at
 * 2 radii.  At the picture's edges only samples inside count; a cylindrical
 * view all the way round continues on the other side.  Sums are made in pfilt's
 * order, so nearly all bytes are the same.
 * Rows of the large picture go in from the top.  Rows of the small one come out
 * as soon as all that they need is there, so only a few rows are in memory.
 *
 * Fireflies: with clamp a sample counts at most that many times the mean of its
 * up to eight neighbours, as they were traced, by the sum of red, green and
 * blue; its colour stays.  The neighbours of a sample on a line one sample wide
 * have a mean of at least a quarter of its radiance, so with clamp 4 or more
 * thin bright lines stay.  Points and highlights of single samples are lost
 * with the fireflies; that is the bias.  Since the sample itself is bounded, it
 * leaves no mark in the pixels around it, as it would if pixels were filtered.
 * Source: pfilt's documentation and pictures; Lee & Redner 1990, A note on the
 * use of nonlinear filtering in computer graphics (remove spikes of stochastic
 * ray tracing before averaging); Rushmeier & Ward 1994, Energy preserving
 * non-linear filters (the cost of that). */
#ifndef RAD_IMAGE_FILTER_H
#define RAD_IMAGE_FILTER_H

#include "base/color.h"
#include "base/error.h"
#include "base/params.h"
#include "image/edge.h"

#include <stdbool.h>
#include <stdint.h>

#define RAD_MAX_OVERSAMPLE 8
#define RAD_MIN_CLAMP      1
#define RAD_MAX_CLAMP      1000

/* How many pixels a side of that many samples becomes, with n samples to a
 * pixel; 0 if the samples are too few. */
int rad_filter_side(int side, int n);

struct rad_filter_shape {
    int width, height; /* of the large picture */
    int oversample;    /* 2..RAD_MAX_OVERSAMPLE; no side may become 0 */
    double clamp;      /* 0: off */
    bool around;       /* its last column is a neighbour of its first */
};

/* The pixel aspect of the small picture, given that of the large one.  Rounding
 * of the sides changes it, which counts if it is more than half a percent. */
double rad_filter_pixaspect(const struct rad_filter_shape *s, double pixaspect);

/* The sample nearest to the middle of pixel i of a row or column; of two the
 * later. */
int rad_filter_middle(int side, int n, int i);

/* Write the options of a picture with `oversample` samples to a pixel as its
 * header has them, and as radsubmit takes them.  p has the size of the rendered
 * picture, the text that of the written one.  With one sample to a pixel it is
 * rad_params_format()'s text. */
#define RAD_FILTER_OPTIONS (RAD_PARAMS_TEXT + 64)
void rad_filter_options(const struct rad_params *p, int oversample,
                        double clamp, char text[RAD_FILTER_OPTIONS]);

struct rad_filter;
/* Make a filter for pixels, or for edges alone (image/edge.h); 0 or RAD_ENOMEM.
 */
int rad_filter_new(struct rad_filter **f, const struct rad_filter_shape *s,
                   struct rad_error *err);
int rad_filter_new_edges(struct rad_filter **f,
                         const struct rad_filter_shape *s,
                         struct rad_error *err);
void rad_filter_free(struct rad_filter *f);

/* Push the next row of the large picture, four bytes a sample (image/hdr.h), at
 * most `height` rows in all. */
void rad_filter_push(struct rad_filter *f, const uint8_t *rgbe);

/* Pull the next row of the small picture; false: it needs further rows, or
 * there are no more. */
bool rad_filter_pull(struct rad_filter *f, struct rad_rgb *row);

/* Of a filter for edges: pull what meets within the pixels of the next row,
 * which has as many at most.  Returns the number; -1: as rad_filter_pull()'s
 * false. */
int rad_filter_pull_edges(struct rad_filter *f, struct rad_edge *edge);

#endif
