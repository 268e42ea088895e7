/* number.h - numbers in scenes, data, options and picture headers
 *
 * Numbers in Radiance's grammar (decimal digits, a point, an exponent).  The
 * whole text must be a number; hexadecimal numbers, infinities and NaNs are not
 * taken.  Numbers are written as the shortest text that reads back as the same
 * bits. */
#ifndef RAD_BASE_NUMBER_H
#define RAD_BASE_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* True, with the double that is nearest, if all of s is one number.  That of a
 * number beyond all doubles is infinite. */
bool rad_read_real(const char *s, double *value);

/* Read the number that begins at p, if it has at most 18 digits and no
 * exponent. The text need not end with a NUL, but has a byte behind p that
 * belongs to no number.  Returns the place behind the last digit or point; a
 * caller has to look whether the number ends there.  NULL, with *value
 * untouched: there is another number, or none. */
const char *rad_take_real(const char *p, double *value);

/* True, with the value, if all of s is one number in range. */
bool rad_parse_real(const char *s, double *value);
bool rad_parse_int(const char *s, int *value);
bool rad_parse_u64(const char *s, uint64_t *value);

/* Room for any number, its NUL included. */
#define RAD_NUMBER_TEXT 32

/* Write the fewest digits that read back as the same double, or float. */
void rad_format_real(char buf[RAD_NUMBER_TEXT], double value);
void rad_format_float(char buf[RAD_NUMBER_TEXT], float value);

/* Write a number of [0, 1e18] for people: "7", "999", "1.25 k", "31.4 M". */
void rad_format_brief(char buf[RAD_NUMBER_TEXT], double value);

/* Order doubles, for qsort(). */
int rad_compare_reals(const void *a, const void *b);

#endif
