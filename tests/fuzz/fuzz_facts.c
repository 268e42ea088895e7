/* fuzz_facts.c - traced pixels from another worker
 *
 * Four bytes say first row, rows, channels and nothing, then come a bitmap and
 * floats; what is missing makes the number of pixels too small.  What is taken
 * is given again as it came. */
#include "config.h"

#include "picture/facts.h"
#include "tests/fuzz/fuzz.h"

#include <stdlib.h>
#include <string.h>

enum { WIDTH = 13, ROWS = 4, STRIDE = 2 };

/* Exactly so long, so that a read beyond it is seen. */
static void *
copy(const uint8_t *from, size_t len)
{
    void *to = malloc(len > 0 ? len : 1);

    if (!to)
        abort();
    if (len > 0)
        memcpy(to, from, len);
    return to;
}

static void
give_again(struct rad_facts *f, int channels)
{
    uint8_t bitmap[ROWS * STRIDE];
    float pixels[4 * WIDTH * ROWS];
    struct rad_facts *g = rad_facts_new(WIDTH, ROWS);
    const struct rad_fact_rows all = { 0, ROWS, channels, 0 };
    size_t n = rad_facts_export(f, &all, bitmap, pixels);

    if (!g || rad_facts_import(g, &all, bitmap, pixels, n) < 0 ||
        rad_facts_unused(g) != n || rad_facts_unused(f) != n)
        abort();
    rad_facts_free(g);
}

int
LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct rad_facts *f = rad_facts_new(WIDTH, ROWS);
    int row, n, channels;
    size_t len, pixel;
    uint8_t *bitmap;
    float *pixels;

    if (!f || size < 4 || size < 4 + STRIDE * (size_t)data[1]) {
        rad_facts_free(f);
        return 0;
    }
    row = (int8_t)data[0];
    n = data[1];
    channels = data[2];
    len = STRIDE * (size_t)n;
    pixel = sizeof(float) * (size_t)(channels > 0 ? channels : 1);
    bitmap = copy(data + 4, len);
    pixels = copy(data + 4 + len, size - 4 - len);
    if (rad_facts_import(f, &(struct rad_fact_rows){ row, n, channels, 0 },
                         bitmap, pixels, (size - 4 - len) / pixel) == 0)
        give_again(f, channels);
    free(bitmap);
    free(pixels);
    rad_facts_free(f);
    return 0;
}
