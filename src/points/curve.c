/* curve.c - see curve.h
 *
 * A cell's number has digits of one bit for each axis.  Its digits differ from
 * the bits of the cell's coordinates by a Gray code, and, for each digit, by an
 * exchange or a reflection of axes in all lower digits (Skilling's transform).
 */
#include "config.h"

#include "points/curve.h"

/* Change all bits below `bit`: if x[i] has `bit`, reflect axis 0; if not,
 * exchange axes 0 and i. */
static void
turn(uint32_t *x, int i, uint32_t bit)
{
    uint32_t low = bit - 1, differ;

    if (x[i] & bit) {
        x[0] ^= low;
    } else {
        differ = (x[0] ^ x[i]) & low;
        x[0] ^= differ;
        x[i] ^= differ;
    }
}

/* The number whose digits are the bits of x[], one bit of each axis a digit. */
static uint64_t
number_of(const uint32_t *x, int axes, int bits)
{
    uint64_t at = 0;

    for (int b = bits - 1; b >= 0; b--)
        for (int i = 0; i < axes; i++)
            at = at << 1 | (x[i] >> b & 1);
    return at;
}

uint64_t
rad_curve_in_cube(const uint32_t cell[3])
{
    uint32_t x[3] = { cell[0], cell[1], cell[2] }, flip = 0;

    for (uint32_t bit = UINT32_C(1) << (RAD_CURVE_BITS - 1); bit > 1; bit >>= 1)
        for (int i = 0; i < 3; i++)
            turn(x, i, bit);
    for (int i = 1; i < 3; i++)
        x[i] ^= x[i - 1];
    for (uint32_t bit = UINT32_C(1) << (RAD_CURVE_BITS - 1); bit > 1; bit >>= 1)
        if (x[2] & bit)
            flip ^= bit - 1;
    for (int i = 0; i < 3; i++)
        x[i] ^= flip;
    return number_of(x, 3, RAD_CURVE_BITS);
}

void
rad_curve_in_square(int bits, uint64_t at, uint32_t cell[2])
{
    uint32_t last;

    cell[0] = cell[1] = 0;
    for (int b = bits - 1; b >= 0; b--) {
        cell[0] |= (uint32_t)(at >> (2 * b + 1) & 1) << b;
        cell[1] |= (uint32_t)(at >> (2 * b) & 1) << b;
    }
    last = cell[1] >> 1;
    cell[1] ^= cell[0];
    cell[0] ^= last;
    for (int b = 1; b < bits; b++)
        for (int i = 1; i >= 0; i--)
            turn(cell, i, UINT32_C(1) << b);
}
