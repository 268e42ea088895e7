/* doubt.h - how far a picture may be off, from what its making showed
 *
 * Two parts, relative and as root mean squares over the picture's pixels, each
 * of them taken with its surroundings of about 5 by 5 pixels, as the eye does:
 *   ambient   records of the cache that overlap do not say quite the same
 *             (struct rad_doubt in trace/job.h): noise of their hemispheres,
 *             and what extrapolation leaves
 *   sampling  pixels that were traced on base lines do not lie on a line:
 *             noise of area lights and gloss, edges that were missed
 * What all records have in common, or no pixel has seen (-ab, -lw, -st too
 * small), does not show.
 * Thread: any, each its own.  */
#ifndef RAD_PICTURE_DOUBT_H
#define RAD_PICTURE_DOUBT_H

#include "picture/quincunx.h"
#include "trace/job.h"

/* Of base lines: squares of second differences, each at most ROUGHEST. */
struct rad_rough {
    double sum, n;
};

/* Count a row of a sampler's area of this width if it is a base line; row and
 * columns are the area's. */
void rad_rough_row(struct rad_rough *r, const struct rad_pixel *pixels,
                   int width, int row, int psample);

struct rad_error_estimate {
    double ambient, sampling, all;
};

/* From the sums of all pixels, whoever says them: each is a number, of 1e6 at
 * most, which is no picture any more. */
struct rad_error_estimate rad_doubt_error(const struct rad_doubt *d,
                                          const struct rad_rough *r,
                                          int psample);

#endif
