/* xform.h - transforms as xform(1) and the scene language write them
 *
 * -t x y z, -rx a, -ry a, -rz a (degrees), -s f, -mx, -my, -mz, and -i n, which
 * repeats the words after it up to the next -i.  They apply from left to right.
 * A transform is an affine map of row vectors: p' = p m + t.
 * Thread: no state.
 * Source: Radiance's manual page xform(1). */
#ifndef RAD_BASE_XFORM_H
#define RAD_BASE_XFORM_H

#include "base/error.h"

#include <stdbool.h>

struct rad_xform {
    double m[3][3]; /* rotation, reflection and scale */
    double t[3];
    double scale; /* > 0 */
};

/* The largest count of -i. */
#define RAD_MAX_XFORM_REPEAT 1000000

void rad_xform_identity(struct rad_xform *x);

/* Is this the first word of a transform? */
bool rad_xform_starts(const char *word);

/* Read a transform of n words.  RAD_EDATA: not a transform, a bad number, a
 * factor of 0, or a result that is not finite. */
int rad_xform_parse(struct rad_xform *x, const char *const *words, int n,
                    struct rad_error *err);

/* *x = a, then b; x may be a or b. */
void rad_xform_then(struct rad_xform *x, const struct rad_xform *a,
                    const struct rad_xform *b);

/* *x = the inverse of a; x may be a. */
void rad_xform_invert(struct rad_xform *x, const struct rad_xform *a);

void rad_xform_point(double out[3], const struct rad_xform *x,
                     const double p[3]);
void rad_xform_vector(double out[3], const struct rad_xform *x,
                      const double v[3]);

#endif
