/* bits.h - sets of up to 64 elements, as bits */
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

#endif
