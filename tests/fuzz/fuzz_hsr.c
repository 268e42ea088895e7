/* fuzz_hsr.c - hyperspectral pictures, and values of what came of them */
#include "scene/file/specpict.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <stdlib.h>

static const double coordinates[] = { -1e30, -1.5, 0,        .5,  1,
                                      2.25,  90,   INFINITY, NAN, 1e30 };

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    double at[3];
    struct rad_error err = { 0 };
    struct rad_arena arena;
    struct rad_data *d;

    rad_arena_init(&arena);
    d = rad_specpict_parse(&arena, data, size, &err);
    if (!d && err.code == 0)
        abort();
    for (size_t i = 0; d && i < 100; i++) {
        for (int k = 0; k < 3; k++)
            at[k] = coordinates[(i * (2 * (size_t)k + 1) + i / 10) % 10];
        rad_data_value(d, at);
    }
    rad_arena_release(&arena);
    return 0;
}
