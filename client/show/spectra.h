/* spectra.h - join the planes of a picture into spectra, or into their colours
 *
 * Each plane is a picture with three bands of wavelengths (base/bands.h).
 * Joined, they make Radiance's hyperspectral picture (.hsr): a header with
 * WAVELENGTH_SPLITS, NCOMP and FORMAT=Radiance_spectra, then for each pixel a
 * byte per band, from the longest waves on, and a common exponent.  Or they
 * make a picture in red, green and blue, or in X, Y and Z, as the eye sees the
 * spectra (image/spectrum.h).
 * A plane's values have eight bits relative to the largest of its three bands,
 * a spectrum's relative to the largest of all: so joining adds an error of one
 * step of either.
 * Thread: any. */
#ifndef RADD_CLIENT_SPECTRA_H
#define RADD_CLIENT_SPECTRA_H

#include "base/error.h"
#include "base/params.h"

#include <stdint.h>

struct spectra_plane {
    const uint8_t *hdr; /* the picture file of the plane */
    size_t len;
};

struct spectra_order {
    struct rad_bands bands;
    bool spectral; /* write a .hsr; else colours in `primaries` */
    enum rad_primaries primaries; /* RAD_PRIM_RGB or RAD_PRIM_XYZ */
};

/* The bands of a plane's picture, and which plane it is, from its header.
 * RAD_EDATA: the header does not say. */
int spectra_bands(const struct spectra_plane *plane, struct rad_bands *bands,
                  struct rad_error *err);

/* Join all planes of the order's bands into one picture: *nout malloc'd bytes
 * in *out.  Its header is that of the first plane, apart from plane and format.
 * RAD_EDATA: these are not pictures of one size; RAD_ENOMEM. */
int spectra_join(const struct spectra_order *order,
                 const struct spectra_plane plane[], uint8_t **out,
                 size_t *nout, struct rad_error *err);

#endif
