/* edge.h - what meets within a pixel
 *
 * A pixel with several samples is their mean, in radiance.  A screen shows
 * nothing brighter than its white, so where a wall meets a window, or the sun's
 * patch a floor, any pixel with some of the bright side is as white as the
 * window: edges that the filter made smooth are jagged again.  A pixel should
 * be the mean of what the screen shows of its samples.  How that is, is not
 * known when samples are filtered, and may be asked for again and otherwise.
 * So a pixel whose samples differ much is told as two: its samples brighter and
 * darker than a threshold between, the mean of each, and the brighter ones'
 * share of the pixel.
 *
 * In a file, edges stand behind the last row of a picture, where other readers
 * do not look: for each row, from the top, their number (two bytes), then each
 * in RAD_EDGE_BYTES: column (two bytes), the share's square root in 1/255, RGBE
 * of the brighter, RGBE of the darker.  At the end the bytes of all this
 * (eight), and a mark. Numbers have their highest byte first. Source: Delp &
 * Mitchell 1979, Image compression using block truncation coding (two levels
 * and a share). Thread: any. */
#ifndef RAD_IMAGE_EDGE_H
#define RAD_IMAGE_EDGE_H

#include "base/color.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The largest radiance of an edge's samples is more than so many times their
 * least.  Below, no curve of tone/tone.h shows much of a difference. */
#define RAD_EDGE_CONTRAST 2

struct rad_edge {
    int x;                       /* column */
    float share;                 /* of the brighter samples, between 0 and 1 */
    struct rad_rgb bright, dark; /* radiance */
};

#define RAD_EDGE_BYTES            11
#define RAD_EDGE_ROW_BYTES(width) (2 + RAD_EDGE_BYTES * (size_t)(width))
#define RAD_EDGE_END_BYTES        24

/* Code a row of n edges into code; returns the bytes. */
size_t rad_edge_encode_row(const struct rad_edge *edge, int n, uint8_t *code);

/* Code the end, behind rows of that many bytes. */
void rad_edge_encode_end(uint64_t bytes, uint8_t code[RAD_EDGE_END_BYTES]);

/* The bytes of a picture's file of n bytes that are not its edges: n where it
 * has none. */
size_t rad_edge_begin(const uint8_t *file, size_t n);

/* The edges of a picture in memory, zeroed where it has none. */
struct rad_edge_rows {
    uint8_t *code; /* of all rows; malloc'd */
    size_t *row;   /* where each row begins in it; malloc'd */
};

/* Take the edges, if there are any, of a file of n bytes, whose picture has
 * this size.  Bytes that are not edges of such a picture are none.
 * RAD_ENOMEM. */
int rad_edges_read(const uint8_t *file, size_t n, int width, int height,
                   struct rad_edge_rows *e, struct rad_error *err);
void rad_edges_release(struct rad_edge_rows *e);

/* The number of row y's edges, and the i-th of them. */
int rad_edges_count(const struct rad_edge_rows *e, int y);
void rad_edges_get(const struct rad_edge_rows *e, int y, int i,
                   struct rad_edge *edge);

#endif
