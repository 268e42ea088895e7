/* legend.h - a scale of colours beside a picture
 *
 * Private to false colour.  Thread: any. */
#ifndef RAD_PICTURE_LEGEND_H
#define RAD_PICTURE_LEGEND_H

#include "image/raster.h"

#include <stdbool.h>

enum { RAD_LEGEND_TICKS = 65, RAD_LEGEND_TEXT = 12 };

struct rad_legend {
    const char *title;
    int nticks; /* from below; where they are too close only some are shown */
    struct rad_legend_tick {
        double at; /* 0 below to 1 above */
        char text[RAD_LEGEND_TEXT];
    } tick[RAD_LEGEND_TICKS];
    /* The colour at a place of the bar. */
    void (*colour)(const void *arg, double at, uint8_t rgb[3]);
    const void *arg;
};

/* Make the image of a picture of that size and its legend, which is drawn;
 * the picture's own pixels, from the upper left corner, are black. RAD_ENOMEM. */
int rad_legend_image(const struct rad_legend *l, int width, int height,
                     struct rad_image *out, struct rad_error *err);

#endif
