/* fuzz_points.c - any bytes as sensor points: the file of a job, then input of
 * each format, which is laid out and packed */
#include "config.h"

#include "points/pointfile.h"
#include "points/points.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>

static void
lay_out(const struct pointfile *f)
{
    uint32_t *pixel = malloc(f->n * sizeof *pixel);
    const double(*point)[6] = (const double(*)[6])f->point;
    struct rad_points p;
    int width, height;

    if (pixel &&
        rad_points_lay(point, f->n, &width, &height, pixel, NULL) == 0) {
        uint8_t *b = rad_points_pack(point, f->n, 0, 0, width, height,
                                     pixel);

        if (b &&
            rad_points_open(&p, b, rad_points_bytes(width, height), NULL) != 0)
            abort();
        free(b);
    }
    free(pixel);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_points p;

    rad_points_open(&p, data, size, NULL);
    for (const char *format = "afd"; *format; format++) {
        struct pointfile f;
        size_t used;

        pointfile_init(&f, "fuzz", *format, UINT32_MAX);
        if (pointfile_more(&f, data, size, true, &used, NULL) == 0 && f.n > 0)
            lay_out(&f);
        pointfile_release(&f);
    }
    return 0;
}
