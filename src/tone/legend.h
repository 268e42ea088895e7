/* legend.h - a colour scale beside a picture
 *
 * Private to falsecolour.c.
 * Thread: any. */
#ifndef RAD_TONE_LEGEND_H
#define RAD_TONE_LEGEND_H

#include "image/raster.h"

enum { RAD_LEGEND_TICKS = 65, RAD_LEGEND_TEXT = 12 };

struct rad_legend {
    const char *title;
    int nticks; /* from the bottom; if they are too close, some are left out,
                 * never the last */
    struct rad_legend_tick {
        double at; /* 0 at the bottom to 1 at the top */
        char text[RAD_LEGEND_TEXT];
    } tick[RAD_LEGEND_TICKS];
    /* The colour at a place of the scale, 0 to 1. */
    void (*colour)(const void *arg, double at, uint8_t rgb[3]);
    const void *arg;
};

/* Make an image for a picture of that size and its legend, and draw the legend.
 * The picture's place, at the upper left, stays black.  RAD_ENOMEM. */
int rad_legend_image(const struct rad_legend *l, int width, int height,
                     struct rad_image *out, struct rad_error *err);

#endif
