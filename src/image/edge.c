/* edge.c - see edge.h */
#include "config.h"

#include "image/edge.h"
#include "base/bits.h"
#include "image/hdr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MARK       "\nradd: edges 1\n"
#define MARK_BYTES 16 /* with the 0 at its end */

size_t
rad_edge_encode_row(const struct rad_edge *edge, int n, uint8_t *code)
{
    uint8_t *to = code + 2;

    rad_store_be(code, (uint64_t)n, 2);
    for (int i = 0; i < n; i++) {
        int root = (int)(sqrtf(edge[i].share) * 255 + .5f);

        rad_store_be(to, (uint64_t)edge[i].x, 2);
        to[2] = (uint8_t)(root < 1 ? 1 : root > 254 ? 254 : root);
        rad_rgbe(edge[i].bright, to + 3);
        rad_rgbe(edge[i].dark, to + 7);
        to += RAD_EDGE_BYTES;
    }
    return (size_t)(to - code);
}

void
rad_edge_encode_end(uint64_t bytes, uint8_t code[RAD_EDGE_END_BYTES])
{
    rad_store_be(code, bytes, 8);
    memcpy(code + 8, MARK, MARK_BYTES);
}

size_t
rad_edge_begin(const uint8_t *file, size_t n)
{
    const uint8_t *end = file + n - RAD_EDGE_END_BYTES;
    uint64_t bytes;

    if (n < RAD_EDGE_END_BYTES || memcmp(end + 8, MARK, MARK_BYTES) != 0)
        return n;
    bytes = rad_load_be(end, 8);
    return bytes <= n - RAD_EDGE_END_BYTES
               ? n - RAD_EDGE_END_BYTES - (size_t)bytes
               : n;
}

/* The bytes of the row of edges at the begin of code; 0: its len bytes do not
 * begin with such a row of a picture of that width. */
static size_t
row_bytes(const uint8_t *code, size_t len, int width)
{
    size_t n = len >= 2 ? (size_t)rad_load_be(code, 2) : len;
    int last = -1;

    if (len < 2 || len < RAD_EDGE_ROW_BYTES(n))
        return 0;
    for (size_t i = 0; i < n; i++) {
        int x = (int)rad_load_be(code + 2 + i * RAD_EDGE_BYTES, 2);

        if (x <= last || x >= width)
            return 0;
        last = x;
    }
    return RAD_EDGE_ROW_BYTES(n);
}

int
rad_edges_read(const uint8_t *file, size_t n, int width, int height,
               struct rad_edge_rows *e, struct rad_error *err)
{
    size_t begin = rad_edge_begin(file, n), len, at = 0;
    int y = 0;

    memset(e, 0, sizeof *e);
    if (begin == n)
        return 0;
    len = n - begin - RAD_EDGE_END_BYTES;
    if (len < 2 * (size_t)height)
        return 0;
    e->row = calloc((size_t)height, sizeof *e->row);
    e->code = malloc(len);
    if (!e->row || !e->code) {
        rad_edges_release(e);
        return rad_fail_memory(err);
    }
    memcpy(e->code, file + begin, len);
    for (; y < height; y++) {
        size_t row = row_bytes(e->code + at, len - at, width);

        e->row[y] = at;
        at += row;
        if (row == 0)
            break;
    }
    if (y < height || at < len)
        rad_edges_release(e);
    return 0;
}

void
rad_edges_release(struct rad_edge_rows *e)
{
    free(e->code);
    free(e->row);
    memset(e, 0, sizeof *e);
}

int
rad_edges_count(const struct rad_edge_rows *e, int y)
{
    return e->row ? (int)rad_load_be(e->code + e->row[y], 2) : 0;
}

void
rad_edges_get(const struct rad_edge_rows *e, int y, int i,
              struct rad_edge *edge)
{
    const uint8_t *at = e->code + e->row[y] + 2 + RAD_EDGE_BYTES * (size_t)i;

    edge->x = (int)rad_load_be(at, 2);
    edge->share = at[2] / 255.f * (at[2] / 255.f);
    edge->bright = rad_rgbe_radiance(at + 3);
    edge->dark = rad_rgbe_radiance(at + 7);
}
