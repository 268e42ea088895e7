/* number.c - see number.h
 *
 * A scene has millions of numbers, so common numbers are converted here.  With
 * at most 19 significant digits that fit in 53 bits, and a power of ten up to
 * 22, one multiplication or division of two exact doubles rounds correctly
 * (Clinger 1990, How to read floating point numbers accurately).  strtod()
 * converts the others. */
#include "config.h"

#include "base/number.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A number as it is written: mantissa * 10^exponent. */
struct decimal {
    uint64_t mantissa; /* the first 19 significant digits at most */
    int digits;        /* significant digits in it */
    int exponent;
    bool negative;
};

static const char *
scan_digits(const char *p, struct decimal *d, bool fraction)
{
    for (; *p >= '0' && *p <= '9'; p++) {
        if (d->digits == 19) {
            d->exponent += !fraction;
            continue;
        }
        d->mantissa = 10 * d->mantissa + (uint64_t)(*p - '0');
        d->digits += d->mantissa != 0;
        d->exponent -= fraction;
    }
    return p;
}

static const char *
scan_exponent(const char *p, struct decimal *d)
{
    bool minus = *p == '-';
    int e = 0;

    p += *p == '-' || *p == '+';
    if (*p < '0' || *p > '9')
        return NULL;
    for (; *p >= '0' && *p <= '9'; p++)
        if (e < 100000)
            e = 10 * e + (*p - '0');
    d->exponent += minus ? -e : e;
    return p;
}

/* Read all of the text at p as a number; false: it is none. */
static bool
scan_decimal(const char *p, struct decimal *d)
{
    const char *first;

    memset(d, 0, sizeof *d);
    d->negative = *p == '-';
    p += *p == '-' || *p == '+';
    first = p;
    p = scan_digits(p, d, false);
    if (*p == '.') {
        first++;
        p = scan_digits(p + 1, d, true);
    }
    if (p == first)
        return false;
    if (*p == 'e' || *p == 'E')
        p = scan_exponent(p + 1, d);
    return p && *p == '\0';
}

/* Set *x to the double nearest to d, if that is exact; else false. */
static bool
convert_exactly(const struct decimal *d, double *x)
{
    static const double ten[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,
                                  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                  1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
                                  1e18, 1e19, 1e20, 1e21, 1e22 };
    double m = (double)d->mantissa;

    if (d->mantissa == 0) {
        *x = d->negative ? -0. : 0.;
        return true;
    }
    /* of 19 digits, behind which more may be left out, it is larger */
    if (d->mantissa > UINT64_C(1) << 53 || d->exponent < -22 ||
        d->exponent > 22)
        return false;
    m = d->exponent < 0 ? m / ten[-d->exponent] : m * ten[d->exponent];
    *x = d->negative ? -m : m;
    return true;
}

bool
rad_read_real(const char *s, double *value)
{
    struct decimal d;

    if (!scan_decimal(s, &d))
        return false;
    if (!convert_exactly(&d, value))
        *value = strtod(s, NULL);
    return true;
}

const char *
rad_take_real(const char *p, double *value)
{
    const char *first, *point = NULL;
    struct decimal d = { .negative = *p == '-' };

    p += *p == '-' || *p == '+';
    for (first = p; (*p >= '0' && *p <= '9') || (*p == '.' && !point); p++)
        if (*p == '.')
            point = p;
        else
            d.mantissa = 10 * d.mantissa + (uint64_t)(*p - '0');
    d.digits = (int)(p - first) - (point != NULL);
    if (d.digits < 1 || d.digits > 18)
        return NULL;
    d.exponent = point ? (int)(point + 1 - p) : 0;
    return convert_exactly(&d, value) ? p : NULL;
}

bool
rad_parse_real(const char *s, double *value)
{
    double v;

    if (!rad_read_real(s, &v) || !isfinite(v))
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

void
rad_format_brief(char buf[RAD_NUMBER_TEXT], double value)
{
    static const char *const unit[] = { "", " k", " M", " G", " T", " P" };
    int i = 0;

    while (value >= 999.5 && i < 5) {
        value /= 1000;
        i++;
    }
    /* three digits, whatever the unit */
    snprintf(buf, RAD_NUMBER_TEXT, "%.*f%s",
             i == 0 || value >= 99.95 ? 0
             : value >= 9.995         ? 1
                                      : 2,
             value, unit[i]);
}

int
rad_compare_reals(const void *a, const void *b)
{
    const double *x = a, *y = b;

    return (*x > *y) - (*x < *y);
}
