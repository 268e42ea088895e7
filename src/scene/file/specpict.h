/* specpict.h - hyperspectral pictures, as functions of position and wavelength
 *
 * A file has a header of lines, which ends with an empty line and contains
 *
 *     NCOMP=n                      channels, 4 to RAD_MAX_BANDS
 *     WAVELENGTH_SPLITS= a b c d   channels range from a to d [nm]; b and c are
 *                                  not used
 *     PIXASPECT= ratio             height / width of a pixel
 *     FORMAT=Radiance_spectra
 *
 * then "-Y height +X width", and height * width pixels, row by row from the
 * top: n mantissas and their common exponent.
 * Memory: all is allocated from the caller's arena, four bytes a channel.
 * Thread: read-only once made.
 * Source: Radiance's file format reference, "Picture file format"; its manual,
 * "Patterns" (specpict). */
#ifndef RAD_SCENE_SPECPICT_H
#define RAD_SCENE_SPECPICT_H

#include "scene/file/data.h"

/* Decode a file into a grid of three dimensions: y, up from the lower edge; x,
 * from the left edge, where the shorter side has length 1; and the wavelength
 * at the middle of a channel [nm].  NULL and *err (RAD_EDATA, RAD_ENOMEM) on
 * failure. */
struct rad_data *rad_specpict_parse(struct rad_arena *arena,
                                    const uint8_t *bytes, size_t len,
                                    struct rad_error *err);

#endif
