/* map.h - what each part of a picture costs
 *
 * Seconds of one processor of speed 1, by row, evenly over the columns; a base
 * line's row costs `base` times what a row of the bar above it does, since more
 * of its pixels are traced.  Where the costs are those of windows, a window
 * costs what those that it covers did, or its part of them. A picture of
 * another size has the same costs stretched over it, and in all as much more as
 * it has more pixels.
 * What the frames show decides which pixels the sampler traces, and of these
 * each has an even part of its row's cost.  It is a picture, or made up: no two
 * pixels near each other are alike, so each one is traced, and guesses at what
 * lies above a unit are never wrong. */
#ifndef SIM_MAP_H
#define SIM_MAP_H

#include "image/hdr.h"
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
    struct rad_picture picture; /* what all frames show; L NULL: made up */
    uint32_t *wanted;           /* pixels of each row that are traced, */
    uint64_t nwanted;           /* and of a frame */
    double window_edge; /* further cost of a window's first row, in pixels of
                         * a row for each of its own: it is sampled finely */
    struct map_window *window; /* of all frames; NULL: row tells the cost */
    size_t nwindows;
};

struct map_spec {
    const char *file;    /* statistics (costs.h); NULL: made up, costs that rise
                          * and fall fourfold over the picture */
    const char *picture; /* an HDR picture, which goes on as in a mirror where
                          * the frames are larger; NULL: made up */
    int width, height;   /* 0: the file's */
    double seconds;      /* in all, of one frame; 0: the file's */
    double base;
    uint32_t nframes; /* of made up ones, or the file's first over and over */
};

/* RAD_ENOINPUT, RAD_EDATA, RAD_EUSAGE, RAD_ENOMEM. */
int map_init(struct map *m, const struct map_spec *s, struct rad_error *err);
void map_release(struct map *m);

/* Of part of row y. */
double map_row(const struct map *m, uint32_t frame, int y, int columns);

/* A pixel of any frame, and what it costs to trace it. */
struct rad_rgb map_pixel(const struct map *m, int x, int y);
double map_pixel_cost(const struct map *m, uint32_t frame, int y);

/* Of a window sampled by itself. */
double map_window(const struct map *m, const struct msg_unit *u);

#endif
