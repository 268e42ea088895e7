/* doubt.h - how far a picture is off, by pixels of it that are made again
 *
 * A few are made twice more, each time with other random numbers and with what
 * -st, -dt and -dj leave out, and are compared with what the picture has there:
 *   areas     of some 25 pixels, as the eye takes them together, as they were
 *             sampled: noise of lamps and gloss, gloss that -st leaves out,
 *             penumbras of lamps whose parts -dj samples by their middles,
 *             edges that interpolation missed
 *   places    a pixel's indirect light sampled afresh and as the cache has it
 * Both times the difference to the truth is the same, but for noise that is
 * independent, so the mean product of both is the square of the error.
 * Errors are relative to the light there, as root mean squares over areas.
 * What both times is left out does not show: bounces that -ab leaves out, light
 * that hemispheres cannot find.
 * Thread: any, each with a context of its own. */
#ifndef RAD_PICTURE_DOUBT_H
#define RAD_PICTURE_DOUBT_H

#include "picture/frame.h"

/* What was found; all add up.  Areas where the picture has contrast, and places
 * where records differ, are more often made again, and count less for it. */
enum rad_doubt_sum {
    RAD_DOUBT_PLACES,  /* whose indirect light was made afresh */
    RAD_DOUBT_AMBIENT, /* products there, of the cache's error */
    RAD_DOUBT_SAID,    /* squares of it there, as records tell */
    RAD_DOUBT_AREAS,   /* that those which were made again stand for */
    RAD_DOUBT_PIXEL,   /* products there, of pixels' error */
    RAD_DOUBT_PIXEL2,  /* and their squares */
    RAD_DOUBT_NOISE,   /* what is left of it where every pixel is traced */
    RAD_DOUBT_SUMS
};
struct rad_doubt {
    double v[RAD_DOUBT_SUMS];
};

/* Of the order the sum depends, in its last bits. */
void rad_doubt_add(struct rad_doubt *to, const struct rad_doubt *more);

struct rad_error_estimate {
    double ambient, sampling, all;
};

/* From sums that may be anything: each is a number, of 1e6 at most, which is no
 * picture any more. */
struct rad_error_estimate rad_doubt_error(const struct rad_doubt *d);

/* The squares of .ambient and .sampling, and what is left of the latter where
 * every pixel is traced, no more than it. */
struct rad_error_squares {
    double ambient, sampling, noise;
};
struct rad_error_squares rad_doubt_squares(const struct rad_doubt *d);

/* How many are made again, of each pixel. */
struct rad_doubt_share {
    double areas, places;
};

/* A few hundred of a picture, and not much of the time that it takes. */
struct rad_doubt_share rad_doubt_of_picture(const struct rad_frame *f);

/* What places that were made again are off by together; all add up. */
struct rad_doubt_off {
    double light, off, square; /* luminance, by how much it is off, with its
                                * sign, and the squares of that */
};

/* Of so many pixels, columns and rows of the picture, make the indirect light
 * of one again, which the key chooses. */
#define RAD_DOUBT_TRIED 8
void rad_doubt_place(const struct rad_frame *f, struct rad_ctx *ctx,
                     uint64_t key, const int at[RAD_DOUBT_TRIED][2],
                     struct rad_doubt *to, struct rad_doubt_off *off);

/* The relative error of the mean of all light, where what places err by in
 * common remains; found at n places. */
double rad_doubt_of_mean(const struct rad_doubt_off *off, double n);

/* Rows of a picture that are done: a base line and the bar above it, as a
 * sampler has made them. */
struct rad_doubt_rows {
    const struct rad_frame *frame;
    int x, y, width, n; /* columns and rows of the picture */
    const struct rad_pixel *const *row;
};

/* Make some areas and places of the rows again: a function of the job and the
 * rows.  What that counts in ctx is the caller's affair.  False: within a pixel
 * of *stop (NULL: nothing stops it). */
bool rad_doubt_look(const struct rad_doubt_rows *rows, struct rad_ctx *ctx,
                    const struct rad_doubt_share *share,
                    const _Atomic bool *stop, struct rad_doubt *to);

#endif
