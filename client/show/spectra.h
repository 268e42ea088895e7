/* spectra.h - planes of a picture put together: spectra, or their colours
 *
 * Each plane is a picture that shows three bands of wavelengths
 * (base/bands.h).  Together they make Radiance's hyperspectral picture (.hsr):
 * a header with WAVELENGTH_SPLITS, NCOMP and FORMAT=Radiance_spectra, then for
 * each pixel a byte a band, the longest waves first, and a common exponent; or
 * a picture in red, green and blue, or X, Y and Z, as the eye sees these
 * spectra (image/spectrum.h). A plane's numbers have eight bits beside the
 * largest of three, a spectrum's beside the largest of all: what is put
 * together is off by one step of either. Thread: any.  */
#ifndef RADD_CLIENT_SPECTRA_H
#define RADD_CLIENT_SPECTRA_H

#include "base/error.h"
#include "base/params.h"

#include <stdint.h>

struct spectra_plane {
    const uint8_t *hdr; /* a picture as it came */
    size_t len;
};

struct spectra_order {
    struct rad_bands bands;
    bool spectral;                /* .hsr, else colours: */
    enum rad_primaries primaries; /* RAD_PRIM_RGB, RAD_PRIM_XYZ */
};

/* The bands of a picture that shows a plane, and which it is, as its header
 * says. RAD_EDATA where it says nothing of them. */
int spectra_bands(const struct spectra_plane *plane, struct rad_bands *bands,
                  struct rad_error *err);

/* The picture of all the planes of the order's bands, whose header is the first
 * one's but for what it says of planes and format: *nout malloc'd bytes in
 * *out.  RAD_EDATA for what are no pictures of one size, RAD_ENOMEM. */
int spectra_join(const struct spectra_order *order,
                 const struct spectra_plane plane[], uint8_t **out,
                 size_t *nout, struct rad_error *err);

#endif
