/* filtered.h - the picture of a job with several samples a pixel, from its rows
 *
 * The coordinator filters, not the workers: a row of pixels needs samples of
 * neighbouring units, which other workers may make; and a picture's bytes must
 * depend on its samples alone, not on the workers or the order of rows.
 * Thread: as rows.h. */
#ifndef DAEMON_FILTERED_H
#define DAEMON_FILTERED_H

#include "proto/message.h"
#include "folder/rows.h"

#include "image/filter.h"

/* Set *s for filtering the rows of a frame of that size and view; RAD_EDATA:
 * the view is no text of jobtext.h's. */
int filtered_shape(struct rad_filter_shape *s, int width, int height,
                   int oversample, double clamp, const char *view,
                   struct rad_error *err);

/* Write the picture, of info's size, as rows_picture() does, and with
 * out->edges what meets within its pixels (image/edge.h).  A preview of more
 * than FILTERED_PREVIEW samples, or half as many with edges, would keep the
 * store's thread for more than half a second; there each pixel is the sample
 * nearest to its middle, and has no edges. */
#define FILTERED_PREVIEW (1 << 25)
int filtered_picture(struct rows *r, const struct rad_filter_shape *s,
                     const struct rad_hdr_info *info,
                     const struct rows_output *out, struct rad_error *err);

#endif
