/* sums.c - see sums.h */
#include "config.h"

#include "machine/sums.h"

#include <math.h>

/* struct msg_doubt has no noise, which only decisions between stages need. */
_Static_assert(MSG_DOUBT_SUMS == RAD_DOUBT_NOISE &&
                   RAD_DOUBT_NOISE + 1 == RAD_DOUBT_SUMS,
               "one for each other");

void
sums_pack(struct wire_out *out, const struct rad_refine_sums *sums)
{
    for (int i = 0; i < RAD_DOUBT_SUMS; i++)
        wire_put_f64(out, sums->doubt.v[i]);
    wire_put_f64(out, sums->off.light);
    wire_put_f64(out, sums->off.off);
    wire_put_f64(out, sums->off.square);
    wire_put_f64(out, sums->shown);
    wire_put_f64(out, sums->rays);
}

static double
get_sum(struct wire_in *in, bool *finite)
{
    double x = wire_get_f64(in);

    *finite &= isfinite(x) != 0;
    return x;
}

bool
sums_unpack(const uint8_t *bytes, size_t len, struct rad_refine_sums *sums)
{
    struct wire_in in;
    bool finite = true;

    wire_in_init(&in, bytes, len);
    for (int i = 0; i < RAD_DOUBT_SUMS; i++)
        sums->doubt.v[i] = get_sum(&in, &finite);
    sums->off.light = get_sum(&in, &finite);
    sums->off.off = get_sum(&in, &finite);
    sums->off.square = get_sum(&in, &finite);
    sums->shown = get_sum(&in, &finite);
    sums->rays = get_sum(&in, &finite);
    return finite && !in.bad && wire_left(&in) == 0;
}

void
sums_count(struct msg_doubt *to, const struct rad_doubt *more)
{
    for (int i = 0; i < MSG_DOUBT_SUMS; i++)
        to->v[i] += more->v[i];
}

struct rad_doubt
sums_counted(const struct msg_doubt *from)
{
    struct rad_doubt out = { { 0 } };

    for (int i = 0; i < MSG_DOUBT_SUMS; i++)
        out.v[i] = from->v[i];
    return out;
}
