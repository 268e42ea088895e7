/* primaries.h - pictures whose numbers are not of Radiance's primaries
 *
 * A PRIMARIES line of a picture's header, as rpict's -pc writes it, says that
 * its numbers, as those of the scene's colours, are amounts of that red, green,
 * blue and white.  For a screen they become sRGB's, and white stays white: what
 * the eye is adapted to changes with it.
 * Numbers of Radiance's own primaries are taken for sRGB's as they are, and so
 * are those without such a line.  By the letter red would grow by a sixth and
 * lose as much of the green, since equal-energy white and D65 differ too; but
 * scenes have their colours from screens and colour pickers, which then would
 * not come out as they went in, and none of Radiance's converters does it.
 * Sources: Radiance's picture format; IEC 61966-2-1; Lam 1985 (Bradford's
 * adaptation). */
#ifndef RAD_PICTURE_PRIMARIES_H
#define RAD_PICTURE_PRIMARIES_H

#include "image/hdr.h"

/* From numbers of the primaries chroma (x y of red, green, blue, white) to
 * those of sRGB's.  false: they span no colours. */
bool rad_primaries_matrix(const double chroma[8], double m[3][3]);

/* Make a picture's numbers sRGB's; colours beyond its primaries lose what is
 * negative. */
void rad_primaries_convert(struct rad_picture *pic);

#endif
