/* primaries.h - pictures whose numbers are not of Radiance's primaries
 *
 * A PRIMARIES line of a picture's header, as rpict's -pc writes it, says that
 * its numbers are amounts of other red, green, blue and white.  White stays
 * white: what the eye is adapted to changes with it.
 * Sources: Radiance's picture format; Lam 1985 (Bradford's adaptation). */
#ifndef RAD_PICTURE_PRIMARIES_H
#define RAD_PICTURE_PRIMARIES_H

#include "picture/hdr.h"

/* From numbers of the primaries chroma (x y of red, green, blue, white) to
 * those of Radiance's.  false: they span no colours. */
bool rad_primaries_matrix(const double chroma[8], double m[3][3]);

/* Make a picture's numbers Radiance's; colours beyond its primaries lose what
 * is negative. */
void rad_primaries_convert(struct rad_picture *pic);

#endif
