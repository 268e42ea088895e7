/* metric.h - differences between two pictures
 *
 * Pictures are in radiance; luminance here is that of base/color.h without the
 * 179 lm/W.  With a and b the test's and the reference's values, L their
 * luminance, and e a thousandth of the mean of Lb:
 *   mean_ratio  mean(La) / mean(Lb)
 *   nrmse       sqrt(mean((a-b)^2 over pixels and channels)) / mean(b)
 *   log_rmse    sqrt(mean(ln((La+e)/(Lb+e))^2))
 *   percentiles of |La-Lb| / (Lb+e), interpolated between neighbours
 *   maxabs      largest |a-b| of any channel / mean(b) */
#ifndef RAD_IMAGE_METRIC_H
#define RAD_IMAGE_METRIC_H

#include "image/hdr.h"

struct rad_metric {
    double mean_ratio, nrmse, log_rmse;
    double p50, p95, p99_9, max;
    double maxabs;
};

struct rad_metric_options {
    int down;    /* average down x down pixels of the test picture first */
    double clip; /* cut values of both at clip * mean(b); 0: do not */
    int block;   /* then average block x block pixels of both */
};

/* Average blocks of n by n pixels; pixels left over at the right and below are
 * dropped.  RAD_EDATA if there is no whole block, RAD_ENOMEM. */
int rad_picture_blocks(const struct rad_picture *in, int n,
                       struct rad_picture *out, struct rad_error *err);

/* Bring two pictures to one size by the options.  *a and *b are new pictures,
 * which the caller releases.  RAD_EDATA if their sizes do not match or a value
 * is not finite. */
int rad_metric_prepare(const struct rad_picture *test,
                       const struct rad_picture *ref,
                       const struct rad_metric_options *o,
                       struct rad_picture *a, struct rad_picture *b,
                       struct rad_error *err);

/* Compare two pictures of one size.  RAD_EDATA: the reference is black. */
int rad_metric_compare(const struct rad_picture *a, const struct rad_picture *b,
                       struct rad_metric *m, struct rad_error *err);

#endif
