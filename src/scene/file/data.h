/* data.h - numbers on a grid, and pictures, as functions of position
 *
 * A data file holds real values on a grid of up to RAD_MAX_DATA_DIMS
 * dimensions:
 *
 *     N
 *     begin end n             N times: n values, at even steps from begin to
 *                             end, or
 *     0 0 n  p1 p2 ... pn     at these places, in rising or falling order
 *     values                  the index of the last dimension varies fastest
 *
 * Words are separated by white space; # starts a comment up to the end of the
 * line.  Between places values are interpolated linearly along each dimension.
 * Beyond the ends they continue in a straight line for one step, and then fall
 * towards 0 like one over the distance.
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
#include "base/files.h"

#include <stdbool.h>
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

/* The number of dimensions, 1 to RAD_MAX_DATA_DIMS. */
int rad_data_dims(const struct rad_data *d);

/* A dimension: the place of its first value, the distance to the last one, and
 * the number of values. */
void rad_data_axis(const struct rad_data *d, int dim, double *begin,
                   double *length, int *n);

/* Make a grid of dims dimensions, with n[] values each at even steps from 0 to
 * length[]; the last dimension begins at `begin` instead.  The caller fills
 * *values, in which the last dimension varies fastest.  NULL: memory is out. */
struct rad_data *rad_data_grid(struct rad_arena *arena, int dims, const int n[],
                               const double length[], double begin,
                               float **values);

/* The value at a place, anywhere.  It is no finite number if a coordinate is
 * none. */
double rad_data_value(const struct rad_data *d, const double at[]);

/* The values of n data of as many dimensions at a place. */
void rad_data_values(const struct rad_data *const d[], int n, const double at[],
                     double value[]);

/* The values at n places that differ in their last coordinate alone, which is
 * in last[]; at[] has the other coordinates. */
void rad_data_row(const struct rad_data *d, const double at[],
                  const double last[], int n, double value[]);

/* Decode a picture file; image/hdr.h names the formats.  kept false: only check
 * it; the picture has no values.  NULL and *err on failure. */
struct rad_pict *rad_pict_parse(struct rad_arena *arena,
                                const struct rad_stream *in, bool kept,
                                struct rad_error *err);

/* Red, green and blue at (x, y), anywhere. */
void rad_pict_value(const struct rad_pict *p, double x, double y,
                    double rgb[3]);

#endif
