/* fuzz_hdr.c - Radiance pictures, to look at and as data */
#include "config.h"

#include "picture/hdr.h"
#include "scene/data.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_picture pic;
    struct rad_error err = { 0 };
    struct rad_coded_picture coded;
    struct rad_arena arena;
    struct rad_pict *p;
    double rgb[3];

    for (int width = 1; width < 40; width += 3)
        if (rad_hdr_row_bytes(data, size, width) > size)
            abort();
    rad_hdr_read(data, size, 1 << 20, &pic, &err);
    rad_picture_release(&pic);
    /* the same again, but for the limit */
    if (rad_hdr_read_coded(data, size, 1 << 20, &coded, NULL) < 0)
        return 0;
    rad_coded_picture_release(&coded);
    rad_arena_init(&arena);
    p = rad_pict_parse(&arena, data, size, NULL);
    for (double x = -3; p && x < 4; x += .37)
        rad_pict_value(p, x, 1 - x, rgb);
    rad_arena_release(&arena);
    return 0;
}
