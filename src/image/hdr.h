/* hdr.h - Radiance pictures: run-length coded RGBE
 *
 * Four bytes a pixel: three mantissas that share an exponent.  The writer
 * makes the same bytes from the same picture: no date, no host.  The reader
 * takes every picture that Radiance wrote: flat, old and new run lengths, any
 * orientation, EXPOSURE and COLORCORR, with and without "#?" at its start;
 * XYZE becomes RGB.
 * Rows count from the top, columns from the left; L is radiance.
 * Source: Ward 1991, Real pixels (Graphics Gems II); Radiance's file format
 * reference, "Picture file format". */
#ifndef RAD_PICTURE_HDR_H
#define RAD_PICTURE_HDR_H

#include "base/color.h"
#include "base/error.h"
#include "base/files.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rad_pixel; /* pixel.h */

/* What a picture's header says of it. */
struct rad_hdr_info {
    const char *origin;   /* lines of where it is from, each with its newline;
                           * NULL: none */
    const char *software; /* "radd 0.1.0"; NULL: not said */
    const char *program;  /* "radsubmit" */
    const char *options; /* rad_params_format()'s text, which also says what
                          * the numbers stand for (-pXYZ, -pc) */
    const char *view;    /* rad_view_format()'s text; NULL: no one view */
    double pixaspect;    /* height / width of a pixel */
    uint32_t frame;      /* 0: a still */
    int width, height;
};

/* The header, the resolution line included. */
int rad_hdr_write_header(const struct rad_hdr_info *info,
                         const struct rad_sink *sink, struct rad_error *err);

/* RGBE of one pixel, rounded as Radiance does: mantissas are cut off, and the
 * reader adds half a step.  A value that is not finite or negative gives 0,
 * one beyond the format's range the largest there is. */
void rad_rgbe(struct rad_rgb L, uint8_t rgbe[4]);
struct rad_rgb rad_rgbe_radiance(const uint8_t rgbe[4]);

/* Code one row of width pixels into out, which has room for
 * RAD_HDR_ROW_BYTES(width), half of it to work in; returns the bytes used.
 * Rows of less than 8 or more than 32767 columns are written flat. */
#define RAD_HDR_ROW_BYTES(width) (8 * ((size_t)(width) + (width) / 128 + 2))
size_t rad_hdr_encode_row(const struct rad_rgb *row, int width, uint8_t *out);
size_t rad_hdr_encode_pixels(const struct rad_pixel *row, int width,
                             uint8_t *out);

/* Bytes of the row of width pixels that code begins with, as one of the two
 * above may have made it; 0 where the len bytes hold no such row.  Never more
 * than RAD_HDR_CODED_BYTES(width) of a row that they did make. */
#define RAD_HDR_CODED_BYTES(width) (RAD_HDR_ROW_BYTES(width) / 2)
size_t rad_hdr_row_bytes(const uint8_t *code, size_t len, int width);

/* Four bytes a pixel of such a row, and back: the bytes are those of the one
 * that was decoded.  rad_hdr_decode_row() returns as rad_hdr_row_bytes(); rgbe,
 * of 4 * width bytes, may be written to where it is 0. */
size_t rad_hdr_decode_row(const uint8_t *code, size_t len, int width,
                          uint8_t *rgbe);
size_t rad_hdr_encode_rgbe(const uint8_t *rgbe, int width, uint8_t *out);

/* A whole picture in memory. */
struct rad_picture {
    int width, height;
    double pixaspect;  /* 1 where the header says nothing */
    struct rad_rgb *L; /* width * height, malloc'd, the top row first */
    bool irradiance;   /* not radiance, as its rendering options say */
    bool other_primaries; /* a PRIMARIES line: the numbers in L are of others */
    double chroma[8];     /* than Radiance's: x y of red, green, blue, white */
};
void rad_picture_release(struct rad_picture *pic);

/* Decode a picture from bytes.  Values are divided by EXPOSURE and COLORCORR.
 * More than max_pixels are refused (RAD_EDATA); memory grows with what was
 * decoded, not with what the resolution line claims.  RAD_EDATA for what is no
 * RGBE picture, is damaged or ends early; *pic is then empty. */
int rad_hdr_read(const uint8_t *data, size_t len, size_t max_pixels,
                 struct rad_picture *pic, struct rad_error *err);

/* The same as it is coded, for what keeps many pixels and looks at few. */
struct rad_coded_picture {
    int width, height;
    double pixaspect;
    uint8_t *rgbe; /* 4 * width * height, malloc'd, the top row first */
};
void rad_coded_picture_release(struct rad_coded_picture *pic);

/* Decode as rad_hdr_read() does, but leave EXPOSURE and COLORCORR alone. */
int rad_hdr_read_coded(const uint8_t *data, size_t len, size_t max_pixels,
                       struct rad_coded_picture *pic, struct rad_error *err);

#endif
