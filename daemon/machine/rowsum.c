/* rowsum.c - see rowsum.h */
#include "config.h"

#include "machine/rowsum.h"

#include "base/rng.h"

#include <string.h>

/* Mix a word into the hash.  One to one in the word, so hashes of bytes that
 * differ in a single word differ here. */
static inline uint64_t
stir(uint64_t h, const uint8_t *bytes)
{
    uint64_t v;

    memcpy(&v, bytes, sizeof v);
    h = (h ^ v) * UINT64_C(0x9e3779b97f4a7c15);
    return h ^ h >> 32;
}

/* Four hashes by turns do not wait for each other: every pixel is hashed here.
 */
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

/* Each row's number is in the sum: else two black rows would cancel out. */
uint64_t
rowsum(const void *pixels, size_t n, uint32_t y, uint32_t rows)
{
    uint64_t sum = 0;

    for (uint32_t i = 0; i < rows; i++)
        sum ^= rad_mix64(rowsum_hash((const char *)pixels + i * n, n) + y + i);
    return sum >> 1;
}
