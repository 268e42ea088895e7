/* quincunx.h - which pixels are traced and which interpolated: rpict's sampler
 *
 * Base lines lie ystep rows apart.  On each, every xstep-th pixel is a sample,
 * offset by half on every other line; the gap between two samples is bisected
 * where its ends differ, or where the densities say that the lines above found
 * detail there.  A bar between two base lines is filled column by column in
 * the same way.
 * A density is the number of pixels that were traced inside a gap; each base
 * line reads those that the line above left and leaves its own.  That is all
 * that a base line needs of the one above: so it may be advanced gap by gap
 * while they arrive, and lines, densities and bars may come from elsewhere.
 * The sampler knows no scene: it asks a callback for pixels, a pure function of
 * (x, y), so its decisions can be made again on pixels that are there already.
 * Rows count from the top: row 0 is the first of the picture.
 * Thread: no state but what the caller holds; one thread for a line or a bar.
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
 * Columns and rows below are the part's, but for those of trace. */
struct rad_quincunx {
    int x0, y0;        /* its first column and row in the picture */
    int width, height; /* at least 1 */
    int xstep, ystep;  /* from -ps */
    double maxdiff;    /* -pt */
    bool depth;        /* z takes part in the decisions */
    rad_trace_fn *trace;
    void *arg;
};

/* The steps are at most these, so a bar has at most one row more. */
enum { RAD_QUINCUNX_MAX_XSTEP = 23, RAD_QUINCUNX_MAX_YSTEP = 16 };

/* xstep and ystep for a -ps value from 1 to 16: a lattice of about ps by ps
 * pixels, sqrt(2) wider than high. */
void rad_quincunx_steps(int psample, int *xstep, int *ystep);

/* Densities that a base line carries; 0 where xstep is at most 2 and there are
 * none. */
size_t rad_quincunx_ndensity(const struct rad_quincunx *q);

/* The densities above base line 0: full. */
void rad_quincunx_start(const struct rad_quincunx *q, uint8_t *density);

/* The densities after a line of which nothing is known: none found, but for
 * those that no line reaches, which stay as they were at the start. */
void rad_quincunx_guess(const struct rad_quincunx *q, uint8_t *density);

/* Base lines: their number, and the row of number i.  Number 0 is row 0; the
 * last is row height - 1, so the last bar may be lower than the others. */
int rad_quincunx_nbases(const struct rad_quincunx *q);
int rad_quincunx_base_row(const struct rad_quincunx *q, int i);

/* Fill base line i into line[width]; density is read (as the line above left
 * it) and changed (for the line below). */
void rad_quincunx_base(const struct rad_quincunx *q, int i, uint8_t *density,
                       struct rad_pixel *line);

/* Fill the bar below base line i: rows[0] is base line i and rows[n] base line
 * i+1 (both given), n their distance; rows between are filled.  Elsewhere bar
 * i + 1: a *line* is a base line and the bar above it (team.h). */
void rad_quincunx_bar(const struct rad_quincunx *q, int i,
                      struct rad_pixel *const rows[]);

/* A base line that is filled gap by gap.  Read x and ndensity; the rest is the
 * sampler's. */
struct rad_quincunx_line {
    const struct rad_quincunx *q;
    int i;
    const uint8_t *above; /* densities of the line above */
    uint8_t *below;       /* for the line below; may be the same array */
    struct rad_pixel *pixels;
    int x;           /* columns 0 to x are final */
    size_t ndensity; /* so many densities of below are final */
    size_t gap;      /* the one that comes next */
    int found;       /* pixels traced in the one before */
};

/* Start base line i; above is NULL where there are no densities.  Column 0 is
 * traced. */
void rad_quincunx_line_start(struct rad_quincunx_line *s,
                             const struct rad_quincunx *q, int i,
                             const uint8_t *above, uint8_t *below,
                             struct rad_pixel *pixels);

/* How many densities of the line above the next gap reads at most. */
size_t rad_quincunx_line_needs(const struct rad_quincunx_line *s);

/* Fill the next gap; false: the line was complete already. */
bool rad_quincunx_line_step(struct rad_quincunx_line *s);

/* A base line that is traced ahead gap by gap in any order: what lies between
 * gap number g's ends depends on the densities above and on nothing else of the
 * line.  Its pixels, both ends included, are filled; with above NULL only what
 * the ends force.  Gap g begins in column rad_quincunx_gap_begin(), and ends
 * where the next one does. */
int rad_quincunx_ngaps(const struct rad_quincunx *q, int i);
int rad_quincunx_gap_begin(const struct rad_quincunx *q, int i, int g);
void rad_quincunx_gap(const struct rad_quincunx *q, int i, int g,
                      const uint8_t *above, struct rad_pixel *pixels);

/* A bar that is filled from the left, as far as its base lines are there.
 * Set to { 0, 0 } first.  To trace ahead from another column than the first,
 * set to { column, 0 }: nothing is known then of the column before it. */
struct rad_quincunx_fill {
    int x;     /* columns that are done */
    int found; /* pixels traced in the last one */
};

/* Fill columns up to but not including `end` of the bar below base line i. */
void rad_quincunx_bar_to(const struct rad_quincunx *q, int i,
                         struct rad_pixel *const rows[],
                         struct rad_quincunx_fill *s, int end);

#endif
