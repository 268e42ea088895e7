/* number.c - see number.h */
#include "config.h"

#include "base/number.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool
rad_parse_real(const char *s, double *value)
{
    double v;
    char *end;

    if (s[0] == '\0' || s[strspn(s, "0123456789+-.eE")] != '\0')
        return false;
    v = strtod(s, &end);
    if (*end != '\0' || end == s || !isfinite(v))
        return false;
    *value = v;
    return true;
}

bool
rad_parse_int(const char *s, int *value)
{
    const char *digits = s + (*s == '-' || *s == '+');
    char *end;
    long v;

    if (*digits == '\0' || digits[strspn(digits, "0123456789")] != '\0')
        return false;
    errno = 0;
    v = strtol(s, &end, 10);
    if (errno != 0 || v < INT_MIN || v > INT_MAX)
        return false;
    *value = (int)v;
    return true;
}

bool
rad_parse_u64(const char *s, uint64_t *value)
{
    unsigned long long v;

    if (*s == '\0' || s[strspn(s, "0123456789")] != '\0')
        return false;
    errno = 0;
    v = strtoull(s, NULL, 10);
    if (errno != 0 || v > UINT64_MAX)
        return false;
    *value = v;
    return true;
}

/* Write a whole number that a double holds exactly without an exponent: 100,
 * not 1e+02. */
static bool
format_whole(char buf[RAD_NUMBER_TEXT], double value)
{
    if (!(fabs(value) < 1e15) || value != floor(value))
        return false;
    snprintf(buf, RAD_NUMBER_TEXT, "%.0f", value);
    return true;
}

void
rad_format_real(char buf[RAD_NUMBER_TEXT], double value)
{
    if (format_whole(buf, value))
        return;
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(buf, RAD_NUMBER_TEXT, "%.*g", digits, value);
        if (strtod(buf, NULL) == value)
            break;
    }
}

void
rad_format_float(char buf[RAD_NUMBER_TEXT], float value)
{
    if (format_whole(buf, (double)value))
        return;
    for (int digits = 1; digits <= 9; digits++) {
        snprintf(buf, RAD_NUMBER_TEXT, "%.*g", digits, (double)value);
        if ((float)strtod(buf, NULL) == value)
            break;
    }
}
