/* number.h - numbers in options, view lines and picture headers
 *
 * Numbers in Radiance's grammar (decimal digits, a point, an exponent).  The
 * whole text must be a number; hexadecimal numbers, infinities and NaNs are not
 * taken.  Numbers are written as the shortest text that reads back as the same
 * bits. */
#ifndef RAD_PICTURE_NUMBER_H
#define RAD_PICTURE_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* True, with the value, if all of s is one number in range. */
bool rad_parse_real(const char *s, double *value);
bool rad_parse_int(const char *s, int *value);
bool rad_parse_u64(const char *s, uint64_t *value);

/* Room for any number, its NUL included. */
#define RAD_NUMBER_TEXT 32

/* Write the fewest digits that read back as the same double, or float. */
void rad_format_real(char buf[RAD_NUMBER_TEXT], double value);
void rad_format_float(char buf[RAD_NUMBER_TEXT], float value);

#endif
