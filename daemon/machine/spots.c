/* spots.c - see spots.h */
#include "config.h"

#include "machine/spots.h"

#include "proto/ambshare.h"

#include <stdlib.h>

#define SPOT_BYTES 6

static size_t
records_for(size_t n)
{
    return (n * SPOT_BYTES + AMBSHARE_BYTES - 1) / AMBSHARE_BYTES;
}

uint32_t
spots_pack(struct wire_out *w, const struct rad_pass_spot *spot, size_t n)
{
    size_t records = records_for(n);

    for (size_t i = 0; i < n; i++)
        for (int axis = 0; axis < 3; axis++)
            wire_put_u16(w, spot[i].at[axis]);
    for (size_t i = n * SPOT_BYTES; i < records * AMBSHARE_BYTES; i++)
        wire_put_u8(w, 0);
    return (uint32_t)records;
}

static void
unpack_tile(struct wire_in *in, struct rad_pass_spot *to, size_t n)
{
    size_t rest = records_for(n) * AMBSHARE_BYTES - n * SPOT_BYTES;

    for (size_t i = 0; i < n; i++)
        for (int axis = 0; axis < 3; axis++)
            to[i].at[axis] = wire_get_u16(in);
    wire_get_view(in, rest);
}

struct rad_pass_spot *
spots_unpack(const struct rad_pass *pass, const uint8_t *bytes, size_t len,
             struct rad_error *err)
{
    size_t all = (size_t)pass->paths * (size_t)pass->walks;
    struct rad_pass_spot *spot = malloc(all * sizeof *spot + 1), *to = spot;
    struct wire_in in;

    if (!spot) {
        rad_fail_memory(err);
        return NULL;
    }
    wire_in_init(&in, bytes, len);
    for (uint32_t i = 0; i < pass->tiles && !in.bad; i++) {
        uint32_t first;
        size_t n =
            (size_t)rad_pass_paths(pass, i, &first) * (size_t)pass->walks;

        unpack_tile(&in, to, n);
        to += n;
    }
    if (!in.bad && wire_left(&in) == 0)
        return spot;
    free(spot);
    rad_fail(err, RAD_EPROTO, "no spots of paths");
    return NULL;
}
