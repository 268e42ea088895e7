/* map.h - what each part of a picture costs
 *
 * Seconds of one processor of speed 1, by row, evenly over the columns; a base
 * line's row costs `base` times what a row of the bar above it does, since more
 * of its pixels are traced.  Where the costs are those of windows, a window
 * costs what those that it covers did, or its part of them. A picture of
 * another size has the same costs stretched over it, and in all as much more as
 * it has more pixels. */
#ifndef SIM_MAP_H
#define SIM_MAP_H

#include "proto/message.h"
#include "picture/quincunx.h"

/* A window that was measured; its sides are in pixels of the map. */
struct map_window {
    uint32_t frame;
    double x0, y0, x1, y1, cost;
};

struct map {
    struct rad_quincunx q; /* of one frame; all are alike in size and ystep */
    int psample;
    uint32_t nframes;
    int nlines;
    double *row; /* nframes * height of them */
    double total;
    double window_edge; /* further cost of a window's first row, in pixels of
                         * a row for each of its own: it is sampled finely */
    struct map_window *window; /* of all frames; NULL: row tells the cost */
    size_t nwindows;
};

struct map_spec {
    const char *file;  /* statistics (costs.h); NULL: made up, costs that rise
                        * and fall fourfold over the picture */
    int width, height; /* 0: the file's */
    double seconds;    /* in all, of one frame; 0: the file's */
    double base;
    uint32_t nframes; /* of made up ones, or the file's first over and over */
};

/* RAD_ENOINPUT, RAD_EDATA, RAD_EUSAGE, RAD_ENOMEM. */
int map_init(struct map *m, const struct map_spec *s, struct rad_error *err);
void map_release(struct map *m);

/* Of part of row y. */
double map_row(const struct map *m, uint32_t frame, int y, int columns);

/* Of a window sampled by itself. */
double map_window(const struct map *m, const struct msg_unit *u);

#endif
