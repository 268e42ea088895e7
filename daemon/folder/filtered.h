/* filtered.h - the picture of a job with several samples a pixel, from its rows
 *
 * Here and not where rows are made: a row of pixels needs the samples of rows
 * beside it, which belong to other units and may come from other workers, and
 * a picture's bytes are to depend on its samples alone, whoever made them, how
 * often and in which order.
 * Thread: as rows.h. */
#ifndef DAEMON_FILTERED_H
#define DAEMON_FILTERED_H

#include "proto/message.h"
#include "folder/rows.h"

#include "image/filter.h"

/* How the frame's rows of that size and view are filtered; RAD_EDATA for texts
 * that are none (jobtext.h). */
int filtered_shape(struct rad_filter_shape *s, int width, int height,
                   int oversample, double clamp, const char *view,
                   struct rad_error *err);

/* As rows_picture(), of info's size.  In a preview of more samples than that,
 * which would keep the store's thread for more than about half a second, each
 * pixel is the one nearest to its middle. */
#define FILTERED_PREVIEW (1 << 25)
int filtered_picture(struct rows *r, const struct rad_filter_shape *s,
                     const struct rad_hdr_info *info,
                     const struct rows_output *out, struct rad_error *err);

#endif
