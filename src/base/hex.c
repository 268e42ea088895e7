/* hex.c - see hex.h */
#include "config.h"

#include "base/hex.h"

#include <string.h>

static const char digits[] = "0123456789abcdef";

void
rad_hex_write(const uint8_t *bytes, size_t n, char *hex)
{
    for (size_t i = 0; i < n; i++) {
        hex[2 * i] = digits[bytes[i] >> 4];
        hex[2 * i + 1] = digits[bytes[i] & 15];
    }
    hex[2 * n] = '\0';
}

/* The value of a digit; -1: it is not one. */
static int
value(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

bool
rad_hex_read(const char *hex, size_t n, uint8_t *bytes)
{
    for (size_t i = 0; i < n; i++) {
        int high = value(hex[2 * i]);
        int low = high < 0 ? -1 : value(hex[2 * i + 1]);

        if (low < 0)
            return false;
        bytes[i] = (uint8_t)(high << 4 | low);
    }
    return true;
}

bool
rad_hex_valid(const char *hex, size_t n)
{
    return strspn(hex, digits) == 2 * n && hex[2 * n] == '\0';
}
