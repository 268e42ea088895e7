/* primaries.h - pictures in primaries other than Radiance's
 *
 * A PRIMARIES line in a picture's header, as rpict -pc writes it, says that its
 * numbers, and those of the scene's colours, are amounts of that red, green and
 * blue, with that white.  For a screen they are converted to sRGB.  White stays
 * white, since the eye's adaptation changes with it.
 * Numbers in Radiance's own primaries, or without a PRIMARIES line, are taken
 * for sRGB as they are.  Strictly converted, red would grow by a sixth and
 * green lose as much, since equal-energy white differs from D65.  But scenes
 * have their colours from screens and colour pickers, and would not show the
 * same colours again; none of Radiance's converters does it either.
 * Sources: Radiance's picture format; IEC 61966-2-1; Lam 1985 (Bradford's
 * adaptation). */
#ifndef RAD_TONE_PRIMARIES_H
#define RAD_TONE_PRIMARIES_H

#include "image/hdr.h"

/* The matrix from numbers in the primaries chroma (x y of red, green, blue,
 * white) to sRGB.  False: the primaries span no colours. */
bool rad_primaries_matrix(const double chroma[8], double m[3][3]);

/* Convert a picture to sRGB; negative channels of colours outside sRGB become
 * 0. */
void rad_primaries_convert(struct rad_picture *pic);

#endif
