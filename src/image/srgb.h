/* srgb.h - linear light as sRGB's numbers
 *
 * Source: IEC 61966-2-1. */
#ifndef RAD_PICTURE_SRGB_H
#define RAD_PICTURE_SRGB_H

#include <stdint.h>

/* The curve as a table of its upper part, in steps of 1/RAD_SRGB_STEPS of each
 * power of 2, between which lines lead.  The error is below .05 of 1/65535. */
enum { RAD_SRGB_STEPS = 256, RAD_SRGB_OCTAVES = 9 };
struct rad_srgb_table {
    float at[RAD_SRGB_OCTAVES * RAD_SRGB_STEPS + 1];
};
void rad_srgb_init(struct rad_srgb_table *t);

/* From 0 to 1; NaN is 0. */
float rad_srgb_encode(const struct rad_srgb_table *t, float linear);

#endif
