/* points.h - sensor points: rays that no view makes, as a picture's pixels
 *
 * A job of sensor points is a picture without a view: each pixel is one point,
 * its ray's origin and direction, or with irradiance a place and the normal of
 * a surface there.  Points near each other in space are near each other in the
 * picture, so lattices and tiles of its pixels (passes/passes.h) are lattices
 * and compact parts of the space that the points are in.
 *
 * They travel as one file of the job, little endian:
 *
 *     8 bytes     "raddpts2"
 *     u32         flags, RAD_POINTS_...
 *     u32 u32     width and height of the picture
 *     u32         points
 *     u64         number of the first point
 *     6 doubles   origin and direction of each pixel's point, row by row; a
 *     u32         direction of zeros: there is none; and which point it is,
 *                 counted from the first
 *
 * Random numbers of a point go by its number, not by its pixel: without an
 * ambient cache its value is the same however points are cut into jobs.
 * The length of a direction says nothing but with RAD_POINTS_LIMITED, where it
 * is how far the ray reaches.
 * Thread: read-only once unpacked. */
#ifndef RAD_POINTS_POINTS_H
#define RAD_POINTS_POINTS_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_POINTS_IRRADIANCE (1u << 0) /* rtrace's -I */
#define RAD_POINTS_LIMITED    (1u << 1) /* rtrace's -ld */
#define RAD_POINTS_FLAGS      3u

/* Most points of a job; 52 bytes each, and a picture of them has at most a
 * third more pixels. */
#define RAD_MAX_POINTS 4000000

struct rad_points {
    uint32_t flags;
    int width, height;
    uint32_t n;           /* points */
    uint64_t first;       /* number of the first */
    const uint8_t *bytes; /* [borrowed] of the pixels */
};

/* Bytes of a whole file for a picture of that size. */
#define RAD_POINTS_HEAD 32
#define RAD_POINT_BYTES 52
size_t rad_points_bytes(int width, int height);

/* The most that a file can have. */
#define RAD_MAX_POINTS_FILE ((size_t)288 << 20)

/* Look at a file of n bytes, which must outlive *p: RAD_EDATA for one that is
 * none, or has a number that is not finite. */
int rad_points_open(struct rad_points *p, const void *bytes, size_t n,
                    struct rad_error *err);

/* The number of a pixel's point; any, where there is none. */
uint64_t rad_points_number(const struct rad_points *p, int x, int y);

/* The point of a pixel of the picture: its origin, and its direction as it was
 * given; false: there is none. */
bool rad_points_at(const struct rad_points *p, int x, int y, double org[3],
                   double dir[3]);

/* Lay n points (each origin, direction), at most RAD_MAX_POINTS, out as a
 * picture: its size, and in pixel[i] the place of point i, row * width +
 * column.  RAD_ENOMEM. */
int rad_points_lay(const double (*point)[6], uint32_t n, int *width,
                   int *height, uint32_t *pixel, struct rad_error *err);

/* The file of points that are laid out so, the first of which has the number
 * `first`; to be freed.  NULL: out of memory. */
uint8_t *rad_points_pack(const double (*point)[6], uint32_t n, uint64_t first,
                         uint32_t flags, int width, int height,
                         const uint32_t *pixel);

#endif
