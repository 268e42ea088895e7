/* fuzz_bsdf.c - XML files of scattering data, and looking them up */
#include "scene/bsdf/bsdf.h"
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static void
look_up(const struct rad_bsdf *b, const double in[3], const double out[3])
{
    double xyz[3], range[2], drawn[3], cell;
    struct rad_bsdf_eye eye;

    rad_bsdf_look_from(b, in, &eye);
    rad_bsdf_value(&eye, out, xyz, &cell);
    rad_bsdf_cells(&eye, range);
    for (int through = 0; through < 2; through++) {
        rad_bsdf_diffuse(b, in[2] > 0, through, xyz);
        for (double x = 0; x < 1; x += .19)
            if (rad_bsdf_sample(&eye, through, x, drawn, xyz) &&
                !(fabs(drawn[0]) <= 1.001 && fabs(drawn[2]) <= 1.001))
                abort();
    }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double v[][3] = {
        { 0, 0, 1 },        { 0, 0, -1 },   { 1, 0, 0 },
        { -.6, .48, .64 },  { 0, .8, -.6 }, { .7071, .7071, -1e-9 },
        { -.36, -.48, .8 },
    };
    enum { N = sizeof v / sizeof v[0] };
    struct rad_error err = { 0 };
    struct rad_arena arena;
    struct rad_bsdf *b;

    rad_arena_init(&arena);
    b = rad_bsdf_parse(&arena, (const char *)data, size, &err);
    if (!b && err.code == 0)
        abort();
    for (int i = 0; b && i < N * N; i++)
        look_up(b, v[i / N], v[i % N]);
    rad_arena_release(&arena);
    return 0;
}
