/* quincunx.h - which pixels are traced and which interpolated: rpict's sampler
 *
 * Base lines lie ystep rows apart.  On each, every xstep-th pixel is a sample,
 * offset by half on every other line; the gap between two samples is bisected
 * where its ends differ, or where the densities say that the lines above found
 * detail there.  A bar between two base lines is filled column by column in
 * the same way.
 * A density is the number of pixels that were traced inside a gap.  Each base
 * line reads the densities that the line above left and leaves its own; it
 * needs nothing else of the line above.  So a base line can advance gap by gap
 * while densities arrive, and lines, densities and bars may be made elsewhere.
 * The sampler knows no scene: it asks a callback for pixels, a pure function of
 * (x, y), so a decision can be made again from pixels that are known already.
 * Rows count from the top: row 0 is the first of the picture.
 * Thread: all state is the caller's; one thread for a line or a bar.
 * Source: rpict(1) on -ps and -pt; Ward 1994, The RADIANCE lighting simulation
 * and rendering system; Painter & Sloan 1989 for the idea of bisecting. */
#ifndef RAD_PICTURE_QUINCUNX_H
#define RAD_PICTURE_QUINCUNX_H

#include "image/pixel.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Trace column x, row y (from the top) of the whole picture. */
typedef void rad_trace_fn(void *arg, int x, int y, struct rad_pixel *out);

/* The part of a picture that is sampled by itself: a window, or all of it.
 * Columns and rows count within the part, except those given to trace. */
struct rad_quincunx {
    int x0, y0;        /* the part's first column and row in the picture */
    int width, height; /* at least 1 */
    int xstep, ystep;  /* from -ps */
    double maxdiff;    /* -pt */
    bool depth;        /* z takes part in the decisions */
    rad_trace_fn *trace;
    void *arg;
};

/* The most that xstep and ystep can be. */
enum { RAD_QUINCUNX_MAX_XSTEP = 23, RAD_QUINCUNX_MAX_YSTEP = 16 };

/* xstep and ystep for a -ps value from 1 to 16: a lattice of about ps by ps
 * pixels, sqrt(2) wider than high. */
void rad_quincunx_steps(int psample, int *xstep, int *ystep);

/* The number of densities that a base line has; 0 if xstep is at most 2. */
size_t rad_quincunx_ndensity(const struct rad_quincunx *q);

/* The densities above base line 0: all pixels traced. */
void rad_quincunx_start(const struct rad_quincunx *q, uint8_t *density);

/* A guess at the densities of a line that is not known: 0, except for those
 * that no line reaches, which keep their values from the start. */
void rad_quincunx_guess(const struct rad_quincunx *q, uint8_t *density);

/* Base lines: their number, and the row of number i.  Number 0 is row 0; the
 * last is row height - 1, so the last bar may be lower than the others. */
int rad_quincunx_nbases(const struct rad_quincunx *q);
int rad_quincunx_base_row(const struct rad_quincunx *q, int i);

/* Fill base line i into line[width].  density holds the densities that the line
 * above left, and is changed to those for the line below. */
void rad_quincunx_base(const struct rad_quincunx *q, int i, uint8_t *density,
                       struct rad_pixel *line);

/* Fill the bar below base line i.  rows[0] is base line i and rows[n] base line
 * i + 1, both given, n rows apart; the rows between are filled.  (Elsewhere
 * this is bar i + 1, since a *line* is a base line and the bar above it:
 * team.h.) */
void rad_quincunx_bar_below(const struct rad_quincunx *q, int i,
                            struct rad_pixel *const rows[]);

/* The state of a base line that is filled gap by gap.  Callers may read x and
 * ndensity. */
struct rad_quincunx_line {
    const struct rad_quincunx *q;
    int i;
    const uint8_t *above; /* densities of the line above */
    uint8_t *below;       /* densities for the line below; may be `above` */
    struct rad_pixel *pixels;
    int x;           /* columns 0 to x are final */
    size_t ndensity; /* so many densities of `below` are final */
    size_t gap;      /* the next gap to fill */
    int found;       /* pixels traced in the gap before `gap` */
};

/* Start base line i and trace its column 0.  above is NULL if there are no
 * densities. */
void rad_quincunx_line_start(struct rad_quincunx_line *s,
                             const struct rad_quincunx *q, int i,
                             const uint8_t *above, uint8_t *below,
                             struct rad_pixel *pixels);

/* How many densities of the line above must be known to fill the next gap. */
size_t rad_quincunx_line_needs(const struct rad_quincunx_line *s);

/* Fill the next gap; false: the line is complete. */
bool rad_quincunx_line_step(struct rad_quincunx_line *s);

/* Gaps of a base line in any order, to trace ahead.  What is traced in a gap
 * depends on the densities above it and on no other gap of the line.
 * rad_quincunx_gap() fills gap g and traces both its ends, into pixels[0] and
 * on, xstep + 1 at most; without densities (above is NULL) it traces only what
 * the ends require.  Gap g lasts from column rad_quincunx_gap_begin(q, i, g) to
 * the begin of gap g + 1. */
int rad_quincunx_ngaps(const struct rad_quincunx *q, int i);
int rad_quincunx_gap_begin(const struct rad_quincunx *q, int i, int g);
void rad_quincunx_gap(const struct rad_quincunx *q, int i, int g,
                      const uint8_t *above, struct rad_pixel *pixels);

/* The state of a bar that is filled from the left, as far as its base lines are
 * known: begin with { 0, 0 }.  To trace ahead from a later column begin with
 * { column, 0 }, as if nothing had been traced in the column before. */
struct rad_quincunx_fill {
    int x;     /* columns before this one are done */
    int found; /* pixels traced in the last column done */
};

/* Fill columns up to but not including `end` of the bar below base line i. */
void rad_quincunx_bar_to(const struct rad_quincunx *q, int i,
                         struct rad_pixel *const rows[],
                         struct rad_quincunx_fill *s, int end);

#endif
