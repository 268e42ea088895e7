/* specpict.h - hyperspectral pictures, as functions of position and wavelength
 *
 * A header of lines, an empty one at its end, in which
 *
 *     NCOMP=n                           channels, 4 to RAD_MAX_BANDS
 *     WAVELENGTH_SPLITS= a b c d        of the first to the last channel: from
 * a to d [nm]; b and c are not used PIXASPECT= ratio                  height /
 * width of a pixel FORMAT=Radiance_spectra
 *
 * "-Y height +X width", and height * width pixels, row by row from the top: n
 * mantissas and an exponent that they share.
 * Memory: all is allocated from the caller's arena, four bytes a channel.
 * Thread: read-only once made.
 * Source: Radiance's file format reference, "Picture file format"; its manual,
 * "Patterns" (specpict). */
#ifndef RAD_SCENE_SPECPICT_H
#define RAD_SCENE_SPECPICT_H

#include "scene/file/data.h"

/* The grid's three dimensions are y, up from the lower edge, x, from the left,
 * where the shorter side is of length 1, and the wavelength at the middle of a
 * channel. NULL and *err (RAD_EDATA, RAD_ENOMEM) on failure. */
struct rad_data *rad_specpict_parse(struct rad_arena *arena,
                                    const uint8_t *bytes, size_t len,
                                    struct rad_error *err);

#endif
