/* fuzz_ambshare.c - any bytes as a batch of ambient records */
#include "config.h"

#include "proto/ambshare.h"
#include "tests/fuzz/fuzz.h"

#include <assert.h>
#include <math.h>

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct wire_in in;
    struct rad_ambrec rec;

    wire_in_init(&in, data, size);
    while (!in.bad && wire_left(&in) > 0)
        if (ambshare_unpack(&in, &rec))
            assert(isfinite(rec.p[0]) && rec.radius[0] > 0 && rec.E.r >= 0 &&
                   rec.weight > 0);
    return 0;
}
