/* raster.h - drawing into an 8 bit picture in memory
 *
 * Three bytes a pixel, the top row first.  Whatever lies outside is cut off.
 * The font is our own: the printable ASCII characters in 5 by 7 dots, with
 * descenders of 2 dots.
 * Thread: any. */
#ifndef RAD_IMAGE_RASTER_H
#define RAD_IMAGE_RASTER_H

#include "base/error.h"

#include <stdint.h>

struct rad_image {
    int width, height;
    uint8_t *rgb; /* malloc'd */
};

enum {
    RAD_FONT_ADVANCE = 6, /* dots from a character to the next */
    RAD_FONT_HEIGHT = 7,  /* of capitals */
    RAD_FONT_LINE = 10    /* from a line to the next */
};

/* Make a black picture; RAD_ENOMEM. */
int rad_image_new(struct rad_image *m, int width, int height,
                  struct rad_error *err);

void rad_image_pixel(struct rad_image *m, int x, int y, const uint8_t rgb[3]);
void rad_image_fill(struct rad_image *m, int x, int y, int width, int height,
                    const uint8_t rgb[3]);

/* Draw text; the upper left corner of the first capital is at x, y, and a dot
 * has sides of `dot` pixels.  A character that the font lacks is drawn as a
 * box. */
void rad_image_text(struct rad_image *m, int x, int y, int dot,
                    const char *text, const uint8_t rgb[3]);

/* The width of text in pixels. */
int rad_image_text_width(const char *text, int dot);

#endif
