/* spectral.h - patterns by spectra: spectrum, specfile, specfunc, specdata,
 * specpict
 *
 * A spectrum becomes the colour that the eye sees (image/spectrum.h).  Those of
 * spectrum and specfile are constant, and computed once.  The function of
 * specfunc is evaluated in the middle of each part of its range; with more than
 * three bands at four places of a part, where Radiance takes one random place.
 * Samples that no band of the plane shows are not evaluated.  effect.h applies
 * the colours.
 * Source: Radiance's reference manual, "Patterns". */
#ifndef RAD_PATTERN_SPECTRAL_H
#define RAD_PATTERN_SPECTRAL_H

#include "trace/material.h"

/* Prepare modifier `index`: *data gets a struct rad_effect.  0 or a code. */
int rad_spectral_prepare(struct rad_job *job, int32_t index,
                         const struct rad_files *files, const void **data,
                         struct rad_error *err);

#endif
