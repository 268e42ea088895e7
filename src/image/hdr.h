/* hdr.h - Radiance pictures: run-length coded RGBE
 *
 * A pixel is four bytes: three mantissas with a common exponent.  The writer
 * makes the same bytes of the same picture: it adds no date and no host.  The
 * reader takes every picture that Radiance ever wrote: flat pixels, old and new
 * run lengths, any orientation, EXPOSURE and COLORCORR, with "#?" at its start
 * or without; XYZE becomes RGB.
 * Rows count from the top, columns from the left; L is radiance.
 * Source: Ward 1991, Real pixels (Graphics Gems II); Radiance's file format
 * reference, "Picture file format". */
#ifndef RAD_IMAGE_HDR_H
#define RAD_IMAGE_HDR_H

#include "base/color.h"
#include "base/error.h"
#include "base/files.h"
#include "image/edge.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rad_pixel; /* pixel.h */

/* The contents of a picture's header. */
struct rad_hdr_info {
    const char *origin;   /* lines about where the picture comes from, each with
                           * its newline; NULL: none */
    const char *software; /* "radd 0.1.0"; NULL: left out */
    const char *program;  /* "radsubmit" */
    const char *options; /* rad_params_format()'s text, which also tells the
                          * colour space (-pXYZ, -pc) */
    const char *view;    /* rad_view_format()'s text; NULL: there is no view */
    double pixaspect;    /* height / width of a pixel */
    uint32_t frame;      /* 0: a still */
    int width, height;
};

/* Write the header with the resolution line. */
int rad_hdr_write_header(const struct rad_hdr_info *info,
                         const struct rad_sink *sink, struct rad_error *err);

/* Convert a pixel to RGBE, and back.  As in Radiance, mantissas are truncated,
 * and the reader adds half a step.  NaN and negative values become 0; infinity
 * and values beyond the format's range become the largest that there is. */
void rad_rgbe(struct rad_rgb L, uint8_t rgbe[4]);
struct rad_rgb rad_rgbe_radiance(const uint8_t rgbe[4]);

/* Convert n bands to the pixel of a hyperspectral picture: n mantissas, cut as
 * those of RGBE, and their exponent. */
void rad_hdr_spectrum(const float band[], int n, uint8_t *pixel);

/* Code a row of width pixels into out, which has room for
 * RAD_HDR_ROW_BYTES(width); half of that is work space.  Returns the bytes
 * used.  Rows of less than 8 or more than 32767 columns are written flat. */
#define RAD_HDR_ROW_BYTES(width) (8 * ((size_t)(width) + (width) / 128 + 2))
size_t rad_hdr_encode_row(const struct rad_rgb *row, int width, uint8_t *out);
size_t rad_hdr_encode_pixels(const struct rad_pixel *row, int width,
                             uint8_t *out);

/* The bytes of the coded row of width pixels at the begin of code; 0 if its len
 * bytes do not begin with such a row.  For a row made by one of the functions
 * above it is at most RAD_HDR_CODED_BYTES(width). */
#define RAD_HDR_CODED_BYTES(width) (RAD_HDR_ROW_BYTES(width) / 2)
size_t rad_hdr_row_bytes(const uint8_t *code, size_t len, int width);

/* Convert a coded row to four bytes a pixel, and back to the same bytes.
 * rad_hdr_decode_row() returns as rad_hdr_row_bytes() does; rgbe has 4 * width
 * bytes, which may be overwritten even if it returns 0. */
size_t rad_hdr_decode_row(const uint8_t *code, size_t len, int width,
                          uint8_t *rgbe);
size_t rad_hdr_encode_rgbe(const uint8_t *rgbe, int width, uint8_t *out);

/* A whole picture in memory. */
struct rad_picture {
    int width, height;
    double pixaspect;  /* 1 if the header does not say */
    struct rad_rgb *L; /* width * height, malloc'd, the top row first */
    bool irradiance;   /* by the options in its header, not radiance */
    bool other_primaries; /* a PRIMARIES line: L has primaries other than */
    double chroma[8];     /* Radiance's: x y of red, green, blue, white */
    struct rad_edge_rows
        edges; /* what meets within pixels, in the units of L */
};
void rad_picture_release(struct rad_picture *pic);

/* The number of its pixels. */
static inline size_t
rad_picture_pixels(const struct rad_picture *pic)
{
    return (size_t)pic->width * (size_t)pic->height;
}

/* Decode a picture.  Values are divided by EXPOSURE and COLORCORR; edges of
 * such pictures, and of other primaries, are left out.  More than max_pixels
 * are refused (RAD_EDATA); memory grows with the rows decoded, not with the
 * size that the file claims.  RAD_EDATA for a file that is no RGBE picture, is
 * damaged or ends early; *pic is empty then. */
int rad_hdr_read(const uint8_t *data, size_t len, size_t max_pixels,
                 struct rad_picture *pic, struct rad_error *err);

/* A picture in coded pixels, for callers that keep many and look at few. */
struct rad_coded_picture {
    int width, height;
    double pixaspect;
    uint8_t *rgbe; /* 4 * width * height, malloc'd, the top row first */
};
void rad_coded_picture_release(struct rad_coded_picture *pic);

/* Decode as rad_hdr_read() does, but without EXPOSURE and COLORCORR; XYZE is
 * refused. */
int rad_hdr_read_coded(const uint8_t *data, size_t len, size_t max_pixels,
                       struct rad_coded_picture *pic, struct rad_error *err);

/* Likewise, from a stream, of which nothing is read ahead but what fits in 64
 * KiB.  kept false: the file is read and checked, and pic->rgbe is NULL. */
int rad_hdr_stream_coded(const struct rad_stream *from, size_t max_pixels,
                         bool kept, struct rad_coded_picture *pic,
                         struct rad_error *err);

#endif
