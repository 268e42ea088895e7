/* fuzz_hdr.c - Radiance pictures, to look at and as data */
#include "config.h"

#include "image/hdr.h"
#include "scene/file/data.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

/* A row is found where it can be decoded, and then codes as itself. */
static void
look_at_row(const uint8_t *data, size_t size, int width)
{
    uint8_t rgbe[4 * 40], again[4 * 40], code[RAD_HDR_ROW_BYTES(40)];
    size_t n = rad_hdr_row_bytes(data, size, width);

    if (n > size || rad_hdr_decode_row(data, size, width, rgbe) != n)
        abort();
    if (n == 0)
        return;
    n = rad_hdr_encode_rgbe(rgbe, width, code);
    if (n > RAD_HDR_CODED_BYTES(width) ||
        rad_hdr_decode_row(code, n, width, again) != n ||
        memcmp(rgbe, again, 4 * (size_t)width) != 0)
        abort();
}

/* What meets within pixels lies in the picture. */
static void
look_at_edges(const struct rad_picture *pic)
{
    for (int y = 0; y < pic->height; y++)
        for (int i = 0; i < rad_edges_count(&pic->edges, y); i++) {
            struct rad_edge e;

            rad_edges_get(&pic->edges, y, i, &e);
            if (e.x < 0 || e.x >= pic->width || !(e.share >= 0) || e.share > 1)
                abort();
        }
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_picture pic;
    struct rad_error err = { 0 };
    struct rad_coded_picture coded, streamed;
    struct rad_memory_in from = { data, size };
    struct rad_stream in = rad_memory_stream(&from);
    struct rad_arena arena;
    struct rad_pict *p;
    double rgb[3];

    for (int width = 1; width < 40; width += 3)
        look_at_row(data, size, width);
    if (rad_hdr_read(data, size, 1 << 20, &pic, &err) == 0)
        look_at_edges(&pic);
    rad_picture_release(&pic);
    if (rad_hdr_read_coded(data, size, 1 << 20, &coded, NULL) < 0) {
        if (rad_hdr_stream_coded(&in, 1 << 20, false, &streamed, NULL) == 0)
            abort();
        return 0;
    }
    if (rad_hdr_stream_coded(&in, 1 << 20, true, &streamed, NULL) < 0 ||
        coded.width != streamed.width || coded.height != streamed.height ||
        memcmp(coded.rgbe, streamed.rgbe,
               4 * (size_t)coded.width * (size_t)coded.height) != 0)
        abort();
    rad_coded_picture_release(&streamed);
    rad_coded_picture_release(&coded);
    /* the same again, but for the limit */
    rad_arena_init(&arena);
    from = (struct rad_memory_in){ data, size };
    p = rad_pict_parse(&arena, &in, true, NULL);
    for (double x = -3; p && x < 4; x += .37)
        rad_pict_value(p, x, 1 - x, rgb);
    rad_arena_release(&arena);
    return 0;
}
