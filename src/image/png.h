/* png.h - PNG files of sRGB pictures
 *
 * The chunk sRGB names the colour space, with perceptual intent.  gAMA and cHRM
 * approximate it for readers that do not know sRGB, with the values that PNG's
 * specification gives. */
#ifndef RAD_IMAGE_PNG_H
#define RAD_IMAGE_PNG_H

#include "base/error.h"
#include "base/files.h"

#include <stdint.h>

struct rad_png {
    int width, height;
    int bits;         /* of a channel: 8 or 16 */
    double pixaspect; /* height of a pixel over its width */
};

/* Fill in row y: width * 3 channels; with 16 bits the upper byte first. */
typedef void rad_png_row_fn(void *arg, int y, uint8_t *out);

/* Write a picture row by row, the top one first.  RAD_ENOMEM, or what the sink
 * returns. */
int rad_png_rows(const struct rad_png *png, rad_png_row_fn *fn, void *arg,
                 const struct rad_sink *sink, struct rad_error *err);

/* Write width by height pixels of three bytes each. */
int rad_png_write(const uint8_t *rgb, int width, int height, double pixaspect,
                  const struct rad_sink *sink, struct rad_error *err);

#endif
