/* text.c - see text.h */
#include "config.h"

#include "base/text.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct range {
    uint32_t first, last;
};

/* clang-format off */
static const struct range unsafe[] = {
    { 0x0001, 0x001f }, { 0x007f, 0x009f }, /* controls */
    { 0x00ad, 0x00ad }, /* soft hyphen */
    { 0x061c, 0x061c }, /* Arabic letter mark */
    { 0x115f, 0x1160 }, /* Hangul fillers: blank */
    { 0x180e, 0x180e }, /* Mongolian vowel separator */
    { 0x200b, 0x200f }, /* zero width; marks of direction */
    { 0x2028, 0x202e }, /* separators; embedding, overrides */
    { 0x2060, 0x206f }, /* word joiner; isolates */
    { 0x3164, 0x3164 }, /* Hangul filler */
    { 0xfeff, 0xfeff }, /* byte order mark */
    { 0xffa0, 0xffa0 }, /* Hangul filler */
    { 0xfff0, 0xfffb }, /* interlinear annotation */
    { 0xe0000, 0xe0fff }, /* tags, variation selectors */
};

static const struct range combining[] = {
    { 0x0300, 0x036f }, { 0x0483, 0x0489 }, { 0x0591, 0x05bd },
    { 0x0610, 0x061a }, { 0x064b, 0x065f }, { 0x0900, 0x0902 },
    { 0x0e34, 0x0e3a }, { 0x0e47, 0x0e4e }, { 0x1ab0, 0x1aff },
    { 0x1dc0, 0x1dff }, { 0x20d0, 0x20ff }, { 0x302a, 0x302d },
    { 0x3099, 0x309a }, { 0xfe00, 0xfe0f }, { 0xfe20, 0xfe2f },
};

static const struct range wide[] = {
    { 0x1100, 0x115f }, { 0x231a, 0x231b }, { 0x2e80, 0x303e },
    { 0x3041, 0x33ff }, { 0x3400, 0x4dbf }, { 0x4e00, 0x9fff },
    { 0xa000, 0xa4cf }, { 0xa960, 0xa97f }, { 0xac00, 0xd7a3 },
    { 0xf900, 0xfaff }, { 0xfe30, 0xfe6f }, { 0xff00, 0xff60 },
    { 0xffe0, 0xffe6 }, { 0x1f300, 0x1f64f }, { 0x1f680, 0x1f6ff },
    { 0x1f900, 0x1f9ff }, { 0x20000, 0x3fffd },
};
/* clang-format on */

#define IN(table, code) within(table, sizeof(table) / sizeof(table)[0], code)

static bool
within(const struct range *r, size_t n, uint32_t code)
{
    for (size_t i = 0; i < n && code >= r[i].first; i++)
        if (code <= r[i].last)
            return true;
    return false;
}

/* Overlong forms, surrogates, code points above U+10FFFF and NUL are not taken
 * for UTF-8 characters. */
size_t
rad_text_char(const char *text, size_t n, uint32_t *code)
{
    static const uint32_t least[] = { 0, 1, 0x80, 0x800, 0x10000 };
    const uint8_t *s = (const uint8_t *)text;
    size_t len = n == 0                  ? 0
                 : s[0] < 0x80           ? 1
                 : (s[0] & 0xe0) == 0xc0 ? 2
                 : (s[0] & 0xf0) == 0xe0 ? 3
                 : (s[0] & 0xf8) == 0xf0 ? 4
                                         : 0;
    uint32_t c;

    if (len == 0 || len > n)
        return 0;
    c = len == 1 ? s[0] : s[0] & (0x7fu >> len);
    for (size_t i = 1; i < len; i++) {
        if ((s[i] & 0xc0) != 0x80)
            return 0;
        c = c << 6 | (s[i] & 0x3f);
    }
    if (c < least[len] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff))
        return 0;
    if (code)
        *code = c;
    return len;
}

size_t
rad_text_mark(const void *text, size_t n)
{
    return n >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

void
rad_text_clean(char *s)
{
    size_t n = strlen(s), to = 0;
    uint32_t code = 0;

    for (size_t i = 0; i < n;) {
        size_t k = rad_text_char(s + i, n - i, &code);

        if (k == 0 || IN(unsafe, code)) {
            s[to++] = '?';
            i += k ? k : 1;
        } else {
            memmove(s + to, s + i, k);
            to += k;
            i += k;
        }
    }
    s[to] = '\0';
}

void
rad_text_trim(char *s)
{
    size_t n = strlen(s), back = 0;

    while (back < 3 && back < n && ((uint8_t)s[n - 1 - back] & 0xc0) == 0x80)
        back++;
    if (back < n && (uint8_t)s[n - 1 - back] >= 0xc0 &&
        rad_text_char(s + n - 1 - back, back + 1, NULL) != back + 1)
        s[n - 1 - back] = '\0';
}

void
rad_text_vprint(char *buf, size_t size, const char *fmt, va_list ap)
{
    int n = vsnprintf(buf, size, fmt, ap);

    if (n < 0)
        buf[0] = '\0';
    else if ((size_t)n >= size)
        rad_text_trim(buf);
}

void
rad_text_print(char *buf, size_t size, const char *fmt, ...)
{
    va_list ap;

    va_start(ap, fmt);
    rad_text_vprint(buf, size, fmt, ap);
    va_end(ap);
}

static size_t
columns_of(uint32_t code)
{
    return IN(combining, code) ? 0 : IN(wide, code) ? 2 : 1;
}

/* The bytes of the first characters that fit in `most` columns; *columns is how
 * many they take. */
static size_t
measure(const char *s, size_t most, size_t *columns)
{
    size_t n = strlen(s), i = 0;
    uint32_t code = 0;

    for (*columns = 0; i < n;) {
        size_t k = rad_text_char(s + i, n - i, &code);
        size_t w = k ? columns_of(code) : 1;

        if (w > most - *columns)
            break;
        *columns += w;
        i += k ? k : 1;
    }
    return i;
}

size_t
rad_text_width(const char *s)
{
    size_t columns;

    measure(s, SIZE_MAX, &columns);
    return columns;
}

size_t
rad_text_fit(const char *s, size_t columns)
{
    size_t taken;

    return measure(s, columns, &taken);
}

/* Write a JSON escape; above U+FFFF it is a surrogate pair. */
static size_t
escape(char *to, uint32_t code)
{
    if (code < 0x10000)
        return (size_t)sprintf(to, "\\u%04x", (unsigned)code);
    return (size_t)sprintf(to, "\\u%04x\\u%04x",
                           (unsigned)(0xd800 + ((code - 0x10000) >> 10)),
                           (unsigned)(0xdc00 + (code & 0x3ff)));
}

void
rad_text_json(const char *text, size_t n, char *out)
{
    size_t to = 0;
    uint32_t code = 0;

    for (size_t i = 0; i < n;) {
        size_t k = rad_text_char(text + i, n - i, &code);

        if (k == 0) {
            out[to++] = '?';
        } else if (code != '\n' && IN(unsafe, code)) {
            to += escape(out + to, code);
        } else {
            memcpy(out + to, text + i, k);
            to += k;
        }
        i += k ? k : 1;
    }
    out[to] = '\0';
}

uint64_t
rad_text_hash(const char *name)
{
    uint64_t h = UINT64_C(0xcbf29ce484222325);

    for (; *name; name++)
        h = (h ^ (unsigned char)*name) * UINT64_C(0x100000001b3);
    return h ^ h >> 32;
}
