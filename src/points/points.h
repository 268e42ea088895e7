/* points.h - sensor points, laid out as the pixels of a picture
 *
 * A job of sensor points is a picture without a view: each pixel is one point,
 * given by the origin and direction of its ray, or with irradiance by a place
 * and the normal of a surface there.  Points near each other in space are near
 * each other in the picture, so lattices and tiles of its pixels
 * (passes/passes.h) are lattices and compact parts of the space of the points.
 *
 * The points are one file of the job, little endian:
 *
 *     8 bytes     "raddpts2"
 *     u32         flags, RAD_POINTS_...
 *     u32 u32     width and height of the picture
 *     u32         points
 *     u64         number of the first point
 *   and for each pixel, row by row,
 *     6 doubles   origin and direction of its point; a direction of zeros: the
 *                 pixel has no point
 *     u32         number of the point, counted from the first
 *
 * The random numbers of a point depend on its number, not on its pixel: without
 * an ambient cache its value is the same however points are cut into jobs.
 * With RAD_POINTS_LIMITED the length of a direction is how far its ray reaches;
 * else it has no meaning.
 * Thread: any; read-only once opened. */
#ifndef RAD_POINTS_POINTS_H
#define RAD_POINTS_POINTS_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_POINTS_IRRADIANCE (1u << 0) /* rtrace's -I */
#define RAD_POINTS_LIMITED    (1u << 1) /* rtrace's -ld */
#define RAD_POINTS_FLAGS      3u

/* At most so many points in a job; their picture has at most a third more
 * pixels, of RAD_POINT_BYTES each. */
#define RAD_MAX_POINTS 4000000

struct rad_points {
    uint32_t flags;
    int width, height;
    uint32_t n;           /* points */
    uint64_t first;       /* number of the first point */
    const uint8_t *bytes; /* [borrowed] the file's pixels */
};

/* The size of a file, for a picture of that size [bytes]. */
#define RAD_POINTS_HEAD 32
#define RAD_POINT_BYTES 52
size_t rad_points_bytes(int width, int height);

/* The largest possible file [bytes]. */
#define RAD_MAX_POINTS_FILE ((size_t)288 << 20)

/* Open a file of n bytes, which must outlive *p.  0, or RAD_EDATA if it is no
 * such file, is damaged, or has a number that is not finite. */
int rad_points_open(struct rad_points *p, const void *bytes, size_t n,
                    struct rad_error *err);

/* The number of a pixel's point; any number, if the pixel has no point. */
uint64_t rad_points_number(const struct rad_points *p, int x, int y);

/* Set org and dir to the point of a pixel, the direction as it was given;
 * false: the pixel has no point. */
bool rad_points_at(const struct rad_points *p, int x, int y, double org[3],
                   double dir[3]);

/* Lay n points (origin and direction), 1 to RAD_MAX_POINTS of them, out as a
 * picture.  Sets the picture's size, and pixel[i] to the pixel of point i, row
 * * width + column.  0 or RAD_ENOMEM. */
int rad_points_lay(const double (*point)[6], uint32_t n, int *width,
                   int *height, uint32_t *pixel, struct rad_error *err);

/* The file, of rad_points_bytes(), of points that rad_points_lay() has laid
 * out; the first point has the number `first`.  malloc'd; NULL: out of
 * memory. */
uint8_t *rad_points_pack(const double (*point)[6], uint32_t n, uint64_t first,
                         uint32_t flags, int width, int height,
                         const uint32_t *pixel);

#endif
