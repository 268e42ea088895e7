/* text.h - text that came from outside, made fit for a terminal or a log
 *
 * A name of somebody else's may hold what a terminal obeys: control characters
 * of ASCII and of ISO 6429 (U+0080 to U+009F), and what nobody sees but turns
 * the line around or hides a part of it: marks and overrides of direction,
 * zero-width characters, line and paragraph separators.  Those, and bytes that
 * are not UTF-8, are unsafe.  Whatever prints text that it did not write sends
 * it through here.
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

/* How many of the n bytes at s are one character, which goes to *code (or
 * NULL); 0: they are not UTF-8, or begin with NUL. */
size_t rad_text_char(const char *s, size_t n, uint32_t *code);

/* Put '?' in place of each character that is unsafe, and of each byte that is
 * no UTF-8. */
void rad_text_clean(char *s);

/* Of text that was cut to fit, drop the character at its end that is not
 * whole. */
void rad_text_trim(char *s);

/* snprintf() that cuts between characters. */
void rad_text_vprint(char *buf, size_t size, const char *fmt, va_list ap)
    __attribute__((format(printf, 3, 0)));
void rad_text_print(char *buf, size_t size, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* Columns of clean text. */
size_t rad_text_width(const char *s);

/* Bytes of its first characters that take so many columns at most. */
size_t rad_text_fit(const char *s, size_t columns);

/* JSON text of n bytes as a terminal can have it: unsafe characters, which
 * stand in its strings alone, as \uXXXX; its newlines stay, and what it says is
 * the same.  malloc'd and terminated; NULL when memory is out. */
char *rad_text_json(const char *text, size_t n);

#endif
