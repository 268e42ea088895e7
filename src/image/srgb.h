/* srgb.h - encoding linear light as sRGB
 *
 * Source: IEC 61966-2-1. */
#ifndef RAD_IMAGE_SRGB_H
#define RAD_IMAGE_SRGB_H

#include <stdint.h>

/* The curve's upper part as a table, in RAD_SRGB_STEPS steps for each power of
 * 2, with linear interpolation.  The error is below .05 of 1/65535. */
enum { RAD_SRGB_STEPS = 256, RAD_SRGB_OCTAVES = 9 };
struct rad_srgb_table {
    float at[RAD_SRGB_OCTAVES * RAD_SRGB_STEPS + 1];
};
void rad_srgb_init(struct rad_srgb_table *t);

/* Encode a value from 0 to 1; values beyond are cut, and NaN gives 0. */
float rad_srgb_encode(const struct rad_srgb_table *t, float linear);

#endif
