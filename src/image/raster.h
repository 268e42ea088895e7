/* raster.h - an 8 bit picture in memory, and what is drawn into it
 *
 * Three bytes a pixel, the top row first.  What lies outside is not drawn.
 * Text is in a font of ours, of 5 by 7 dots with descenders of 2: the printable
 * ASCII.  Thread: any. */
#ifndef RAD_PICTURE_RASTER_H
#define RAD_PICTURE_RASTER_H

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

/* Black; RAD_ENOMEM. */
int rad_image_new(struct rad_image *m, int width, int height,
                  struct rad_error *err);

void rad_image_pixel(struct rad_image *m, int x, int y, const uint8_t rgb[3]);
void rad_image_fill(struct rad_image *m, int x, int y, int width, int height,
                    const uint8_t rgb[3]);

/* Text whose first capital has its upper left corner at x, y; dot: pixels of a
 * dot's side.  What the font lacks is a box. */
void rad_image_text(struct rad_image *m, int x, int y, int dot,
                    const char *text, const uint8_t rgb[3]);

/* Pixels that text is wide. */
int rad_image_text_width(const char *text, int dot);

#endif
