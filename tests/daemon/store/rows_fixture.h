/* rows_fixture.h - pixels of a small picture, each of which tells its place */
#ifndef RADD_TESTS_ROWS_FIXTURE_H
#define RADD_TESTS_ROWS_FIXTURE_H

#include "image/hdr.h"

#include <stddef.h>
#include <stdint.h>

enum { W = 10, H = 6 };

static inline float
value(int x, int y, int c)
{
    return (float)(1 + x + 100 * y) + 0.25f * (float)c;
}

/* Rows of w pixels as they travel; returns the bytes. */
static inline size_t
code_rows(int x, int y, int w, int h, uint8_t *code)
{
    struct rad_rgb line[W];
    size_t n = 0;

    for (int j = y; j < y + h; j++) {
        for (int i = 0; i < w; i++)
            line[i] = rad_rgb(value(x + i, j, 0), value(x + i, j, 1),
                              value(x + i, j, 2));
        n += rad_hdr_encode_row(line, w, code + n);
    }
    return n;
}

#endif
