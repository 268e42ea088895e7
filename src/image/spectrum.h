/* spectrum.h - the colour of a spectrum, or its values in bands
 *
 * A spectrum is n samples, each the mean over its part of a range of
 * wavelengths.  Beyond the range it counts as 0.  Its colour is what the CIE
 * 1931 observer (2 degrees) sees, in Radiance's primaries; if these cannot show
 * the colour it is made paler.  A spectrum of 1 everywhere is white.
 * As in Radiance, a spectrum's samples are first converted to bands of the
 * job's range (at most RAD_MAX_BANDS), bands end at whole nanometres, and three
 * bands are red, green and blue as they are.
 * In a job of more than three bands (base/bands.h) the colour of a spectrum is
 * its mean over each of the three bands of a plane.
 * Thread: read-only once made.
 * Sources: CIE 1931 observer in steps of 5 nm (CIE 15:2004, table T.4);
 * Radiance's reference manual, "Patterns" (spectrum). */
#ifndef RAD_IMAGE_SPECTRUM_H
#define RAD_IMAGE_SPECTRUM_H

#include "base/arena.h"
#include "base/bands.h"
#include "base/color.h"

struct rad_spectrum;

/* Prepare the conversion of spectra of n samples, n at least 1, to these bands.
 * The first sample begins at wavelength begin and the last one ends at end
 * [nm]; either may be the longer one, but they differ.  NULL: memory is out. */
const struct rad_spectrum *rad_spectrum_new(struct rad_arena *arena, int n,
                                            double begin, double end,
                                            const struct rad_bands *to);

/* Does sample i count in any channel? */
bool rad_spectrum_shows(const struct rad_spectrum *sp, int i);

/* Add sample i to a sum that starts as 0. */
void rad_spectrum_add(const struct rad_spectrum *sp, int i, double sample,
                      double sum[3]);

/* Turn the sum of all samples into the colour.  It is the sum itself, unless
 * that is red, green and blue and one of these is negative. */
void rad_spectrum_colour(const struct rad_spectrum *sp, double sum[3]);

#endif
