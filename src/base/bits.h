/* bits.h - numbers as sets of up to 64 elements, and as bytes */
#ifndef RAD_BASE_BITS_H
#define RAD_BASE_BITS_H

#include <stdint.h>

/* The number of elements. */
static inline int
rad_count_bits(uint64_t v)
{
    int n = 0;

    for (; v; v &= v - 1)
        n++;
    return n;
}

/* The number in n bytes, 8 at most, of which the first is the highest. */
static inline uint64_t
rad_load_be(const uint8_t *p, int n)
{
    uint64_t v = 0;

    for (int i = 0; i < n; i++)
        v = v << 8 | p[i];
    return v;
}

/* Put a number as n such bytes. */
static inline void
rad_store_be(uint8_t *p, uint64_t v, int n)
{
    for (int i = n; i-- > 0; v >>= 8)
        p[i] = (uint8_t)v;
}

#endif
