/* hex.h - bytes as hexadecimal digits, and back
 *
 * Two digits a byte, the higher half first.
 * Thread: any. */
#ifndef RAD_BASE_HEX_H
#define RAD_BASE_HEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* n bytes as 2n digits, 0-9 a-f, and a NUL. */
void rad_hex_write(const uint8_t *bytes, size_t n, char *hex);

/* n bytes of the first 2n characters; false: one of these is no digit (A-F
 * are), and then bytes may hold anything. */
bool rad_hex_read(const char *hex, size_t n, uint8_t *bytes);

/* Is it as rad_hex_write() makes it of n bytes, with nothing behind? */
bool rad_hex_valid(const char *hex, size_t n);

#endif
