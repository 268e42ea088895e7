/* quincunx.h - which pixels are traced and which interpolated: rpict's sampler
 *
 * Base lines lie ystep rows apart; on each, samples xstep pixels apart, offset
 * by half on every other line, and densities that one base line hands to the
 * next decide where the gaps between samples are traced or interpolated; a bar
 * between two base lines is filled column by column in the same way.
 * The sampler is an object that knows no scene: it asks a callback for pixels,
 * which is a pure function of (x, y), so the decisions can be replayed on
 * pixels that were traced before, and it can be fed a base line and its
 * densities from outside.
 * Rows count from the top here: row 0 is the first of the picture.
 * Source: rpict(1) on -ps and -pt; Ward 1994; Painter & Sloan 1989 for the
 * idea of bisecting. */
#ifndef RAD_PICTURE_QUINCUNX_H
#define RAD_PICTURE_QUINCUNX_H

#include "base/color.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rad_pixel {
    struct rad_rgb L;
    float z; /* distance, with -z only; else 0 */
};

/* Trace column x, row y (from the top) of the whole picture. */
typedef void rad_trace_fn(void *arg, int x, int y, struct rad_pixel *out);

/* The part of a picture that is sampled by itself: a window, or all of it. */
struct rad_quincunx {
    int x0, y0;        /* its first column and row in the picture */
    int width, height;
    int xstep, ystep;  /* from -ps */
    double maxdiff;    /* -pt */
    bool depth;        /* z takes part in the decisions */
    rad_trace_fn *trace;
    void *arg;
};

/* Samples of density that a base line carries: one for each sample and one
 * more; 0 when xstep <= 2, where there is no density. */
size_t rad_quincunx_ndensity(const struct rad_quincunx *q);

/* xstep and ystep for a -ps value; both at least 1. */
void rad_quincunx_steps(int psample, int *xstep, int *ystep);

/* Base lines of the part: their number, and the row (from y0) of number i.
 * Number 0 is row 0; the last is row height-1. */
int rad_quincunx_nbases(const struct rad_quincunx *q);
int rad_quincunx_base_row(const struct rad_quincunx *q, int i);

/* The densities before base line 0. */
void rad_quincunx_start(const struct rad_quincunx *q, uint8_t *density);

/* Fill base line i into line[width]; density is read (as the line above left
 * it) and changed (for the line below). */
void rad_quincunx_base(const struct rad_quincunx *q, int i, uint8_t *density,
                       struct rad_pixel *line);

/* Fill the bar below base line i: rows[0] is base line i and rows[n] base line
 * i+1 (both given), n their distance; rows between are filled. */
void rad_quincunx_bar(const struct rad_quincunx *q, int i,
                      struct rad_pixel *const rows[]);

#endif
