/* bits.h - access to the bits of IEEE 754 doubles
 *
 * Thread: any; pure functions. */
#ifndef RAD_ARITH_BITS_H
#define RAD_ARITH_BITS_H

#include <stdint.h>
#include <string.h>

static inline uint64_t
rad_bits_of(double x)
{
    uint64_t u;

    memcpy(&u, &x, sizeof u);
    return u;
}

static inline double
rad_double_of(uint64_t bits)
{
    double x;

    memcpy(&x, &bits, sizeof x);
    return x;
}

/* 2^e, -1022 <= e <= 1023 */
static inline double
rad_power_of_two(int e)
{
    return rad_double_of((uint64_t)(e + 1023) << 52);
}

#endif
