/* filter.h - a picture made of a larger one of N by N times the samples
 *
 * Does what pfilt(1) does with -1 -x /N -y /N -r .6: each pixel is a mean of
 * the samples about it, weighed by a Gaussian of the distance with a radius of
 * .6 pixels that is flat inside a sample's own area and cut off at 2 radii.
 * At the picture's edges the samples that are there count; a cylindrical view
 * all around goes on at the other side.  Sums are made in the order that pfilt
 * makes them in, so the bytes are nearly always the same.
 * Rows of the large picture go in from the top, those of the small one come out
 * as soon as all that they need is there: memory is that of some rows.
 *
 * Fireflies: with clamp a sample counts at most that many times the mean of the
 * up to eight samples about it, as they were traced, by the sum of red, green
 * and blue; its colour stays.  What is one sample wide and goes on to both
 * sides has a quarter of its own radiance about it at least, so from 4 on thin
 * bright lines stay; points and highlights of single samples are lost with the
 * rest, which is the bias.  It is the weight of a spike that is bounded, so
 * that there is no mark of it in the pixels about, as with filters of pixels.
 * Source: pfilt's documentation and pictures; Lee & Redner 1990, A note on the
 * use of nonlinear filtering in computer graphics (spikes of stochastic ray
 * tracing go before means are taken); Rushmeier & Ward 1994, Energy preserving
 * non-linear filters (what that costs). */
#ifndef RAD_PICTURE_FILTER_H
#define RAD_PICTURE_FILTER_H

#include "base/color.h"
#include "base/error.h"
#include "base/params.h"

#include <stdbool.h>
#include <stdint.h>

#define RAD_MAX_OVERSAMPLE 8
#define RAD_MIN_CLAMP      1
#define RAD_MAX_CLAMP      1000

/* Columns or rows that side samples become, by n of them a pixel; 0 where they
 * are too few. */
int rad_filter_side(int side, int n);

struct rad_filter_shape {
    int width, height; /* of the large picture */
    int oversample;    /* 2..RAD_MAX_OVERSAMPLE, and it leaves a pixel */
    double clamp;      /* 0: off */
    bool around;       /* its last column lies beside its first */
};

/* Pixel aspect of the small picture, from that of the large one: rounding of
 * sides changes it, which shows beyond half a percent. */
double rad_filter_pixaspect(const struct rad_filter_shape *s, double pixaspect);

/* The sample whose place is nearest to the middle of pixel i of a row or
 * column; of two the later. */
int rad_filter_middle(int side, int n, int i);

/* The options of a picture of so many samples a pixel as its header has them,
 * and radsubmit takes them: p has the size of what is rendered, they have that
 * of what is written.  With one sample a pixel they are rad_params_format()'s
 * text. */
#define RAD_FILTER_OPTIONS (RAD_PARAMS_TEXT + 64)
void rad_filter_options(const struct rad_params *p, int oversample,
                        double clamp, char text[RAD_FILTER_OPTIONS]);

struct rad_filter;
/* RAD_ENOMEM.  Free it with rad_filter_free(). */
int rad_filter_new(struct rad_filter **f, const struct rad_filter_shape *s,
                   struct rad_error *err);
void rad_filter_free(struct rad_filter *f);

/* The next row of the large picture, four bytes a sample (image/hdr.h); of
 * height of them at most. */
void rad_filter_push(struct rad_filter *f, const uint8_t *rgbe);

/* The next row of the small picture; false: it needs more rows first, or all
 * rows are out. */
bool rad_filter_pull(struct rad_filter *f, struct rad_rgb *row);

#endif
