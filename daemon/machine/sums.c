/* sums.c - see sums.h */
#include "config.h"

#include "machine/sums.h"

#include <math.h>

void
sums_pack(struct wire_out *out, const struct rad_refine_sums *sums)
{
    for (int i = 0; i < RAD_REFINE_SUMS; i++)
        wire_put_f64(out, sums->v[i]);
}

bool
sums_unpack(const uint8_t *bytes, size_t len, struct rad_refine_sums *sums)
{
    struct wire_in in;
    bool finite = true;

    wire_in_init(&in, bytes, len);
    for (int i = 0; i < RAD_REFINE_SUMS; i++) {
        sums->v[i] = wire_get_f64(&in);
        finite &= isfinite(sums->v[i]) != 0;
    }
    return finite && !in.bad && wire_left(&in) == 0;
}
