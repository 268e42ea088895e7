/* hex.h - bytes as hexadecimal digits, and back
 *
 * Two digits a byte, the higher half first.
 * Thread: any. */
#ifndef RAD_BASE_HEX_H
#define RAD_BASE_HEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Write n bytes as 2n digits, 0-9 a-f, and a NUL. */
void rad_hex_write(const uint8_t *bytes, size_t n, char *hex);

/* Read n bytes from the first 2n characters.  False if one of these is no digit
 * (A-F are digits); bytes may hold anything then. */
bool rad_hex_read(const char *hex, size_t n, uint8_t *bytes);

/* Is hex a string of exactly 2n digits, as rad_hex_write() writes them? */
bool rad_hex_valid(const char *hex, size_t n);

#endif
