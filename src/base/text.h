/* text.h - text from outside, made safe for a terminal or a log
 *
 * A name that somebody else chose may hold unsafe characters.  A terminal obeys
 * control characters of ASCII and ISO 6429 (U+0080 to U+009F).  Others are
 * invisible, but reverse a line or hide a part of it: marks and overrides of
 * direction, zero-width characters, line and paragraph separators.  Bytes that
 * are not UTF-8 are unsafe, too.  All foreign text goes through here before it
 * is printed.
 * Widths are columns of a terminal: 2 for the ideographs, kana, Hangul and
 * pictographs of East Asia, 0 for marks that combine, else 1.
 * Sources: The Unicode Standard 15, general categories Cc and Cf, East Asian
 *          Width (UAX #11), Bidirectional Algorithm (UAX #9).
 * Thread: any. */
#ifndef RAD_BASE_TEXT_H
#define RAD_BASE_TEXT_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

/* The length in bytes of the first character of s, which has n bytes; *code
 * (may be NULL) is its code point.  0: it is not UTF-8, or NUL. */
size_t rad_text_char(const char *s, size_t n, uint32_t *code);

/* The length of the byte-order mark that n bytes of text begin with, 3 or 0.
 * Windows' editors put one at the beginning of a file; it means nothing. */
size_t rad_text_mark(const void *text, size_t n);

/* Replace each unsafe character, and each byte that is not UTF-8, by '?'. */
void rad_text_clean(char *s);

/* Drop an incomplete character at the end of text that was cut to fit. */
void rad_text_trim(char *s);

/* vsnprintf() and snprintf() that cut between characters. */
void rad_text_vprint(char *buf, size_t size, const char *fmt, va_list ap)
    __attribute__((format(printf, 3, 0)));
void rad_text_print(char *buf, size_t size, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* The columns that clean text takes. */
size_t rad_text_width(const char *s);

/* The bytes of the first characters of clean text that take at most so many
 * columns. */
size_t rad_text_fit(const char *s, size_t columns);

/* A hash of a name, for tables: FNV-1a, with its high half mixed in, since
 * tables use the low bits. */
uint64_t rad_text_hash(const char *name);

/* Make n bytes of JSON text safe for a terminal: unsafe characters become
 * \uXXXX, which means the same, since they occur only in strings; newlines
 * stay.  out has RAD_TEXT_JSON_ROOM(n) bytes, and is terminated. */
#define RAD_TEXT_JSON_ROOM(n) (6 * (n) + 1)
void rad_text_json(const char *text, size_t n, char *out);

#endif
