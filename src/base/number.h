/* number.h - numbers in options, view lines and picture headers
 *
 * Radiance's grammar (decimal digits, a point, an exponent), read whole, and
 * the shortest text that reads back as the same bits.  Hexadecimal numbers,
 * infinities and NaNs are no numbers here. */
#ifndef RAD_PICTURE_NUMBER_H
#define RAD_PICTURE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* True and the value if all of s is one finite number. */
bool rad_parse_real(const char *s, double *value);
bool rad_parse_int(const char *s, int *value);
bool rad_parse_u64(const char *s, uint64_t *value);

/* Room for any number, its NUL included. */
#define RAD_NUMBER_TEXT 32

/* The fewest digits that give the same double again; the float one gives the
 * same float again. */
void rad_format_real(char buf[RAD_NUMBER_TEXT], double value);
void rad_format_float(char buf[RAD_NUMBER_TEXT], float value);

#endif
