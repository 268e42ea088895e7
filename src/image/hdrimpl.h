/* hdrimpl.h - what writing and reading pictures share: which rows are coded
 *
 * Private to hdr.c, which writes, and hdrread.c.
 * A row in the new form is 2, 2, its length in two bytes, then each of the
 * four components by itself: a count above 128 repeats the next byte count -
 * 128 times, another is followed by that many bytes.  In the old form a pixel
 * of 1, 1, 1, n repeats the one before n times, and each such pixel that
 * follows directly counts 256 times as much. */
#ifndef RAD_PICTURE_HDRIMPL_H
#define RAD_PICTURE_HDRIMPL_H

#include "image/hdr.h"

/* Rows of other lengths are flat, or in the old form. */
enum { SHORTEST_CODED = 8, LONGEST_CODED = 32767 };

static inline bool
is_flat(int width)
{
    return width < SHORTEST_CODED || width > LONGEST_CODED;
}

#endif
