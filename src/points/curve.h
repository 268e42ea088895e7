/* curve.h - Hilbert's curve through cubes and squares
 *
 * The curve goes through all cells of a grid, each beside the cell before, so
 * places that are close on the curve are close in space.
 * Source: Skilling 2004, Programming the Hilbert curve.
 * Thread: any. */
#ifndef RAD_POINTS_CURVE_H
#define RAD_POINTS_CURVE_H

#include <stdint.h>

/* The cube has 2 to this power cells along each side. */
#define RAD_CURVE_BITS 21

/* The number of a cell on the curve through the cube. */
uint64_t rad_curve_in_cube(const uint32_t cell[3]);

/* The column and row of cell number `at` of the curve through a square of
 * 2^bits cells a side, bits at most 31. */
void rad_curve_in_square(int bits, uint64_t at, uint32_t cell[2]);

#endif
