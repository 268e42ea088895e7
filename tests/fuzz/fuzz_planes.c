/* fuzz_planes.c - pictures of planes: which they are, and put together */
#include "show/spectra.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

/* All planes alike, as they would be of grey light. */
static void
join(const struct spectra_plane *one, const struct rad_bands *bands,
     bool spectral)
{
    struct spectra_plane plane[RAD_MAX_PLANES];
    struct spectra_order order = { *bands, spectral,
                                   bands->n % 2 ? RAD_PRIM_XYZ : RAD_PRIM_RGB };
    struct rad_error err = { 0 };
    uint8_t *out = NULL;
    size_t n = 0, sum = 0;

    for (int k = 0; k < RAD_MAX_PLANES; k++)
        plane[k] = *one;
    if (spectra_join(&order, plane, &out, &n, &err) < 0) {
        if (err.code == 0)
            abort();
        return;
    }
    for (size_t i = 0; i < n; i++)
        sum += out[i];
    if (n == 0 || sum == 0)
        abort();
    free(out);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct spectra_plane one = { data, size };
    struct rad_bands bands = { 5, 780, 380, 0 };
    struct rad_error err = { 0 };

    if (spectra_bands(&one, &bands, &err) < 0 && err.code == 0)
        abort();
    join(&one, &bands, true);
    join(&one, &bands, false);
    return 0;
}
