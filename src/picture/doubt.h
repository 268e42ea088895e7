/* doubt.h - the error of a picture, estimated from pixels rendered again
 *
 * A few pixels are rendered again, once or twice, each time with other random
 * numbers and with the light that -st, -dt and -dj leave out, and compared with
 * the picture:
 *   areas     of some 25 pixels, traced or interpolated, since the eye averages
 *             over so many; of the picture that is written, whose pixels are
 *             several rendered ones each with rad_frame.oversample.  They show
 *             noise of lamps and gloss, gloss below
 *             -st, penumbras of lamps whose parts -dj samples at their middles,
 *             edges that interpolation missed.
 *   places    pixels whose indirect light is sampled anew, to compare with what
 *             the ambient cache gives; the second rendering is of another pixel
 *             of the same area
 * Both renderings of a pixel differ from the picture by the same error, each
 * with noise of its own.  So the mean product of the two differences is the
 * mean square of the error.  Errors are relative to the light of the area or
 * place; a picture's error is the root mean square over areas.
 * Light that both renderings lack does not show: light that hemispheres cannot
 * find, and bounces beyond -ab.  These are estimated apart: from places paths
 * are followed by -ab bounces and more, to surfaces whose indirect light the
 * cache knows.
 * Thread: any, each with a context of its own. */
#ifndef RAD_PICTURE_DOUBT_H
#define RAD_PICTURE_DOUBT_H

#include "image/filter.h"
#include "picture/frame.h"

#include <math.h>

/* Sums over all areas and places that were looked at; those of several threads
 * add up.  Rough areas, and places where records predict errors, are
 * chosen more often, and each counts less for that. */
enum rad_doubt_sum {
    RAD_DOUBT_PLACES,  /* number of places */
    RAD_DOUBT_AMBIENT, /* products of the cache's relative errors at places, and
                        * what deeper records add */
    RAD_DOUBT_SAID,    /* squares of these errors, as records predict them for
                        * areas: errors of records average out in an area in
                        * which many records serve */
    RAD_DOUBT_BEYOND,  /* light of more bounces than -ab at places, relative to
                        * the light that they have */
    RAD_DOUBT_AREAS,   /* number of areas that the areas looked at stand for */
    RAD_DOUBT_PIXEL,   /* products of the areas' relative errors */
    RAD_DOUBT_PIXEL2,  /* squares of these products */
    RAD_DOUBT_NOISE,   /* squares of the noise that an area would have if all
                        * its pixels were traced */
    RAD_DOUBT_SUMS
};
struct rad_doubt {
    double v[RAD_DOUBT_SUMS];
};

/* The last bits of a sum depend on the order of the additions. */
void rad_doubt_add(struct rad_doubt *to, const struct rad_doubt *more);

struct rad_error_estimate {
    double ambient, sampling, all;
};

/* The largest relative error that is told: nothing of the picture is right. */
#define RAD_DOUBT_MOST 1e6

/* A sum or an estimate, such as the square of an error, as a number to reckon
 * with: NaN and negative numbers become 0, large numbers are cut. */
static inline double
rad_doubt_sound(double square)
{
    return square > 0 ? fmin(square, RAD_DOUBT_MOST * RAD_DOUBT_MOST) : 0;
}

/* The relative errors that the sums stand for, whatever the sums are: each
 * result is a number from 0 to RAD_DOUBT_MOST. */
struct rad_error_estimate rad_doubt_error(const struct rad_doubt *d);

/* The share of all light, from 0 to 1, that the picture lacks because it comes
 * by more bounces than -ab: a mean over places.  0 where it is not known:
 * without a cache, with -ab 1, and with -av or -aw, which stand for it. */
double rad_doubt_left_out(const struct rad_doubt *d);

/* The squares of .ambient and .sampling, and of the part of .sampling that
 * would be left if every pixel were traced. */
struct rad_error_squares {
    double ambient, sampling, noise;
};
struct rad_error_squares rad_doubt_squares(const struct rad_doubt *d);

/* The side of an area, in pixels of the picture that is written. */
#define RAD_DOUBT_SIDE 5

/* Per rendered pixel, how many areas and places to look at; with INFINITY
 * areas each area.  With rad_frame.oversample an area counts for the 25 pixels
 * that are written, so as many times fewer are looked at. */
struct rad_doubt_share {
    double areas, places;
};

/* Shares that give a few hundred areas of a picture, fewer with
 * rad_frame.oversample, and some fifty places, or eight in a small one: a small
 * part of the picture's own time.  Sensor points have no areas. */
struct rad_doubt_share rad_doubt_of_picture(const struct rad_frame *f);

/* The error that places have in common: sums over places, signed so that noise
 * cancels.  The sums of several threads add up. */
struct rad_doubt_off {
    double light, off, square; /* luminance, fresh less cached luminance with
                                * what deeper records add, and squares of this
                                * difference */
};

/* Look at one place: choose a pixel of at[] (columns and rows in the picture)
 * by the key and render its indirect light again.  off may be NULL. */
#define RAD_DOUBT_TRIED 8
void rad_doubt_place(const struct rad_frame *f, struct rad_ctx *ctx,
                     uint64_t key, const int at[RAD_DOUBT_TRIED][2],
                     struct rad_doubt *to, struct rad_doubt_off *off);

/* The relative error of the mean of all light, found at n places: noise of the
 * places cancels in it, an error that they share does not. */
double rad_doubt_of_mean(const struct rad_doubt_off *off, double n);

/* Finished rows of a picture: a base line and the bar above it, as a sampler
 * made them. */
struct rad_doubt_rows {
    const struct rad_frame *frame;
    int x, y, width, n; /* columns and rows of the picture */
    const struct rad_pixel *const *row;
};

/* Look at some areas and places of the rows: which areas and places, and the
 * result, are functions of the job and the rows.  The rays count in ctx like
 * any other rays; a caller that does not want this subtracts them again.  False
 * if *stop was set meanwhile (NULL: never); the function returns within one
 * pixel then. */
bool rad_doubt_look(const struct rad_doubt_rows *rows, struct rad_ctx *ctx,
                    const struct rad_doubt_share *share,
                    const _Atomic bool *stop, struct rad_doubt *to);

/* Look at all rows of a window that rad_frame_window() has rendered.  Row 0 is
 * left out, for it is sampled more densely than the others, unless there are no
 * others.  Otherwise as rad_doubt_look(). */
bool rad_doubt_look_at_window(const struct rad_doubt_rows *window,
                              struct rad_ctx *ctx,
                              const struct rad_doubt_share *share,
                              const _Atomic bool *stop, struct rad_doubt *to);

#endif
