/* spectrum.h - the colour that a spectrum has to the eye, or bands have of it
 *
 * A spectrum is n samples, each the mean over its part of a range of
 * wavelengths; nothing is known beyond the range, and counts as 0.  Its colour
 * is what the CIE 1931 observer (2 degrees) sees of it, in Radiance's
 * primaries, made paler where these cannot show it; a spectrum of 1 everywhere
 * is white. As in Radiance, where a spectrum's samples are turned into bands of
 * the job's range first (RAD_MAX_BANDS of them at most), bands end at whole
 * nanometres, and three are red, green and blue as they are.
 * Where a job has more than three bands (base/bands.h), the colour of a
 * spectrum is its mean over each of the three that a plane shows. Thread:
 * read-only once made. Sources: CIE 1931 observer in steps of 5 nm (CIE
 * 15:2004, table T.4); Radiance's reference manual, "Patterns" (spectrum). */
#ifndef RAD_IMAGE_SPECTRUM_H
#define RAD_IMAGE_SPECTRUM_H

#include "base/arena.h"
#include "base/bands.h"
#include "base/color.h"

struct rad_spectrum;

/* What spectra of n samples are to those bands, where the first begins at
 * wavelength begin and the last ends at end [nm], either of which may be the
 * longer one.  n is at least 1, and begin is not end.  NULL: out of memory. */
const struct rad_spectrum *rad_spectrum_new(struct rad_arena *arena, int n,
                                            double begin, double end,
                                            const struct rad_bands *to);

/* Does any channel show of sample i? */
bool rad_spectrum_shows(const struct rad_spectrum *sp, int i);

/* Add sample i to a sum that begins as 0. */
void rad_spectrum_add(const struct rad_spectrum *sp, int i, double sample,
                      double sum[3]);

/* The colour of the sum of all samples, in its place: the sum itself, but
 * where it is red, green and blue and one of them negative. */
void rad_spectrum_colour(const struct rad_spectrum *sp, double sum[3]);

#endif
