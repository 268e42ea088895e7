/* hdrimpl.h - the format of a row, for writing and reading pictures
 *
 * Private to hdr.c, which writes, and hdrread.c.
 * A row in the new form is 2, 2, its length in two bytes, then each of the four
 * components by itself: a count above 128 repeats the next byte count - 128
 * times; any other count is followed by that many bytes.  In the old form a
 * pixel of 1, 1, 1, n repeats the pixel before it n times, and if more such
 * pixels follow, each counts 256 times as much as the last. */
#ifndef RAD_IMAGE_HDRIMPL_H
#define RAD_IMAGE_HDRIMPL_H

#include "image/hdr.h"

/* Rows of other lengths are flat or in the old form. */
enum { SHORTEST_CODED = 8, LONGEST_CODED = 32767 };

static inline bool
is_flat(int width)
{
    return width < SHORTEST_CODED || width > LONGEST_CODED;
}

#endif
