/* rowsum.c - see rowsum.h */
#include "config.h"

#include "machine/rowsum.h"

#include "base/rng.h"

#include <string.h>

/* One to one for a word, so rows that differ in one never look the same. */
static inline uint64_t
stir(uint64_t h, const uint8_t *bytes)
{
    uint64_t v;

    memcpy(&v, bytes, sizeof v);
    h = (h ^ v) * UINT64_C(0x9e3779b97f4a7c15);
    return h ^ h >> 32;
}

/* Four by turns, that do not wait for each other: every pixel comes by here. */
uint64_t
rowsum_hash(const void *from, size_t n)
{
    const uint8_t *bytes = from;
    uint64_t h[4] = { n, 1, 2, 3 }, v = 0;

    for (; n >= 32; bytes += 32, n -= 32)
        for (int k = 0; k < 4; k++)
            h[k] = stir(h[k], bytes + 8 * k);
    for (; n >= 8; bytes += 8, n -= 8)
        h[0] = stir(h[0], bytes);
    memcpy(&v, bytes, n);
    for (int k = 0; k < 4; k++)
        v = rad_mix64(v ^ h[k]);
    return v ? v : 1;
}

/* The row's number is in it: black rows would cancel each other. */
uint64_t
rowsum(const void *pixels, size_t n, uint32_t y, uint32_t rows)
{
    uint64_t sum = 0;

    for (uint32_t i = 0; i < rows; i++)
        sum ^= rad_mix64(rowsum_hash((const char *)pixels + i * n, n) + y + i);
    return sum >> 1;
}
