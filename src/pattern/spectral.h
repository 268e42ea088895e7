/* spectral.h - patterns by spectra: spectrum, specfile, specfunc, specdata,
 * specpict
 *
 * A spectrum has the colour that it has to the eye (image/spectrum.h).  Those
 * of spectrum and specfile are the same everywhere, and made once.  The
 * function of specfunc is asked at the middle of each of its parts, or with
 * more than three bands at four places of it, where Radiance takes a random
 * one.  Samples that no band of a plane shows are not asked for.  What is
 * prepared is shaded by effect.h.
 * Source: Radiance's reference manual, "Patterns". */
#ifndef RAD_SHADE_SPECTRAL_H
#define RAD_SHADE_SPECTRAL_H

#include "trace/material.h"

int rad_spectral_prepare(struct rad_job *job, int32_t index,
                         const struct rad_files *files, const void **data,
                         struct rad_error *err);

#endif
