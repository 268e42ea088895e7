/* png.h - pictures for the eye: tone mapping, and PNG files
 *
 * The tone curve is global and depends on the picture alone: the log-average
 * luminance is brought to a middle grey, and what is much brighter is bent
 * below white by a shoulder, so that lamps and windows keep some shape in
 * interiors and skies do not burn out by day.
 * Sources: Reinhard, Stark, Shirley & Ferwerda 2002, Photographic tone
 * reproduction for digital images (equations 1 and 4); IEC 61966-2-1 (sRGB).
 * Radiance's primaries are taken for sRGB's, from which they differ by .01 in
 * the green's x. */
#ifndef RAD_PICTURE_PNG_H
#define RAD_PICTURE_PNG_H

#include "base/files.h"
#include "picture/hdr.h"

struct rad_tone {
    double scale; /* of luminance, so that the picture's average is .25 */
    double white; /* scaled luminance that becomes 1 */
};

/* The curve for a picture's pixels; black ones do not count. */
struct rad_tone rad_tone_of(const struct rad_rgb *L, size_t n);

/* One pixel through the curve, as 8 bit sRGB. */
void rad_tone_map(const struct rad_tone *t, struct rad_rgb L, uint8_t rgb[3]);

/* 8 bit sRGB for linear values from 0 to 1; others are clipped. */
uint8_t rad_srgb(double linear);

/* Write width by height pixels of three bytes, the top row first, as a PNG.
 * pixaspect is the height of a pixel over its width.  RAD_ENOMEM, or what the
 * sink returns. */
int rad_png_write(const uint8_t *rgb, int width, int height, double pixaspect,
                  const struct rad_sink *sink, struct rad_error *err);

/* A picture through its own tone curve into a PNG. */
int rad_png_picture(const struct rad_picture *pic, const struct rad_sink *sink,
                    struct rad_error *err);

#endif
