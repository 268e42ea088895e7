/* data.h - numbers on a grid, and pictures, as functions of position
 *
 * A data file holds real values on a grid of up to RAD_MAX_DATA_DIMS
 * dimensions:
 *
 *     N
 *     begin end n             N times: n values, evenly from begin to end, or
 *     0 0 n  p1 p2 ... pn     at these places, in rising or falling order
 *     values                  those of the last dimension follow each other
 *
 * Words are parted by white space; # starts a comment that ends with its line.
 * Between its places a value is interpolated linearly along each dimension;
 * beyond the ends it goes on in a straight line as far as one step, and falls
 * from there towards 0 as one over the distance.
 *
 * A picture is such a grid of two dimensions for each of three channels, with
 * the origin at its lower left, x to the right, y up, and the shorter side of
 * length 1.  Its values are those of the file: EXPOSURE is not undone.
 *
 * Memory: all is allocated from the caller's arena.
 * Thread: read-only once made.
 * Source: Radiance's reference manual, "Patterns" (brightdata, colorpict), and
 * its data files. */
#ifndef RAD_SCENE_DATA_H
#define RAD_SCENE_DATA_H

#include "base/arena.h"
#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

#define RAD_MAX_DATA_DIMS   6
#define RAD_MAX_DATA_PIXELS ((size_t)1 << 28)

struct rad_data;
struct rad_pict;

/* Parse a data file's text.  NULL and *err (RAD_EDATA with the line,
 * RAD_ENOMEM) on failure. */
struct rad_data *rad_data_parse(struct rad_arena *arena, const char *text,
                                size_t len, struct rad_error *err);

/* How many dimensions it has, 1 to RAD_MAX_DATA_DIMS. */
int rad_data_dims(const struct rad_data *d);

/* A dimension: its first place, how far from there the last one is, and how
 * many values it has. */
void rad_data_axis(const struct rad_data *d, int dim, double *begin,
                   double *length, int *n);

/* A grid of dims dimensions with n[] values each, evenly from 0 (but for the
 * last dimension: from begin) to length[]; *values is to be filled in, the last
 * dimension's neighbours.  NULL: out of memory. */
struct rad_data *rad_data_grid(struct rad_arena *arena, int dims, const int n[],
                               const double length[], double begin,
                               float **values);

/* The value at a place of as many coordinates.  Anywhere; no finite number
 * where a coordinate is none. */
double rad_data_value(const struct rad_data *d, const double at[]);

/* Decode a picture file (image/hdr.h says which).  NULL and *err on failure.
 */
struct rad_pict *rad_pict_parse(struct rad_arena *arena, const uint8_t *bytes,
                                size_t len, struct rad_error *err);

/* Red, green and blue at (x, y); anywhere. */
void rad_pict_value(const struct rad_pict *p, double x, double y,
                    double rgb[3]);

#endif
