/* lex.c - see lex.h
 *
 * Nearly all words and numbers lie whole in the buffer, and are read in place,
 * up to the NUL behind the buffer's text.  Others (which continue in the next
 * buffer, have quotes, or are wrong) are read from their beginning, character
 * by character, by code that handles all cases. */
#include "config.h"

#include "scene/file/lex.h"
#include "base/number.h"
#include "base/text.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define END (-1) /* of the text, or of the part that could be read */

void
rad_lex_init(struct rad_lex *lex, const struct rad_stream *in)
{
    lex->in = *in;
    lex->line = 1;
    lex->rc = 0;
    lex->eof = false;
    lex->pos = lex->len = 0;
    lex->buf[0] = '\0';
    lex->word[0] = '\0';
}

/* Read the next buffer; the first without a byte-order mark.  A file with a NUL
 * is no text, and is refused. */
static bool
refill(struct rad_lex *lex, struct rad_error *err)
{
    bool first = lex->len == 0;
    long n;

    if (lex->eof || lex->rc)
        return false;
    n = lex->in.read(lex->in.arg, lex->buf, sizeof lex->buf - 1, err);
    lex->len = n > 0 ? (size_t)n : 0;
    lex->pos = first ? rad_text_mark(lex->buf, lex->len) : 0;
    lex->eof = n == 0;
    if (n < 0)
        lex->rc = (int)n;
    else if (n > 0 && memchr(lex->buf, 0, (size_t)n))
        lex->rc = rad_fail(err, RAD_EDATA,
                           "not a scene description: it has binary data");
    if (lex->rc)
        lex->pos = lex->len = 0;
    lex->buf[lex->len] = '\0';
    return lex->len > 0;
}

static int
peek(struct rad_lex *lex, struct rad_error *err)
{
    while (lex->pos == lex->len) /* again if a buffer has a mark alone */
        if (!refill(lex, err))
            return END;
    return lex->buf[lex->pos];
}

static int
next(struct rad_lex *lex, struct rad_error *err)
{
    int c = peek(lex, err);

    if (c != END) {
        lex->pos++;
        lex->line += c == '\n';
    }
    return c;
}

static bool
is_space(int c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static int
skip_space(struct rad_lex *lex, struct rad_error *err)
{
    do {
        const unsigned char *p = lex->buf + lex->pos;

        for (; is_space(*p); p++)
            lex->line += *p == '\n';
        lex->pos = (size_t)(p - lex->buf);
        if (*p)
            return *p;
    } while (peek(lex, err) != END);
    return END;
}

/* Skip white space and comments; returns the character after them. */
static int
skip_comments(struct rad_lex *lex, struct rad_error *err)
{
    int c;

    while ((c = skip_space(lex, err)) == '#')
        while ((c = next(lex, err)) != '\n' && c != END)
            ;
    return c;
}

int
rad_lex_next(struct rad_lex *lex, struct rad_error *err)
{
    int c = skip_comments(lex, err);

    if (lex->rc)
        return lex->rc;
    if (c == END)
        return RAD_TOKEN_END;
    if (c != '!')
        return RAD_TOKEN_WORD;
    next(lex, err);
    return RAD_TOKEN_COMMAND;
}

static int
unexpected_end(struct rad_lex *lex, const char *what, struct rad_error *err)
{
    if (lex->rc)
        return lex->rc;
    return rad_fail(err, RAD_EDATA, "text ends where %s is expected", what);
}

/* Read a word in place; false: it is not whole in the buffer, or has quotes. */
static bool
take_word(struct rad_lex *lex)
{
    const unsigned char *first = lex->buf + lex->pos, *p = first;
    size_t n;

    while (*p > ' ' && *p != '"' && *p != '\'')
        p++;
    n = (size_t)(p - first);
    if (!is_space(*p) || n > RAD_MAX_WORD)
        return false;
    memcpy(lex->word, first, n);
    lex->word[n] = '\0';
    lex->pos += n;
    return true;
}

int
rad_lex_word(struct rad_lex *lex, const char *what, struct rad_error *err)
{
    size_t n = 0;
    int quote = 0, c = skip_space(lex, err), line = lex->line;

    if (c == END)
        return unexpected_end(lex, what, err);
    if (take_word(lex))
        return 0;
    for (; c != END; c = peek(lex, err)) {
        if (!quote && is_space(c))
            break;
        next(lex, err);
        if (c == quote) {
            quote = 0;
        } else if (!quote && (c == '"' || c == '\'')) {
            quote = c;
        } else if (n == RAD_MAX_WORD) {
            lex->word[24] = '\0';
            return rad_fail(err, RAD_EDATA,
                            "word of more than %d bytes: '%s...'", RAD_MAX_WORD,
                            lex->word);
        } else {
            lex->word[n++] = (char)c;
        }
    }
    lex->word[n] = '\0';
    if (lex->rc)
        return lex->rc;
    if (quote)
        return rad_fail(err, RAD_EDATA,
                        "the quote %c opened in line %d is not closed", quote,
                        line);
    return 0;
}

static int
number_word(struct rad_lex *lex, const char *what, struct rad_error *err)
{
    if (skip_comments(lex, err) == END)
        return unexpected_end(lex, what, err);
    return rad_lex_word(lex, what, err);
}

int
rad_lex_count(struct rad_lex *lex, const char *what, int max, int *n,
              struct rad_error *err)
{
    int rc = number_word(lex, what, err);
    const char *p = lex->word;
    bool minus = *p == '-';
    long v = 0;

    if (rc)
        return rc;
    p += minus || *p == '+';
    if (*p < '0' || *p > '9')
        return rad_fail(err, RAD_EDATA, "expected %s, got '%s'", what,
                        lex->word);
    for (; *p >= '0' && *p <= '9'; p++)
        if (v <= max)
            v = 10 * v + (*p - '0');
    if (*p || (minus && v > 0))
        return rad_fail(err, RAD_EDATA, "expected %s, got '%s'", what,
                        lex->word);
    if (v > max)
        return rad_fail(err, RAD_EDATA, "%s is %s, at most %d is possible",
                        what, lex->word, max);
    *n = (int)v;
    return 0;
}

int
rad_lex_real(struct rad_lex *lex, double *x, struct rad_error *err)
{
    const char *p;
    int rc;

    if (skip_comments(lex, err) == END)
        return unexpected_end(lex, "a real argument", err);
    p = rad_take_real((const char *)lex->buf + lex->pos, x);
    if (p && is_space((unsigned char)*p)) {
        lex->pos = (size_t)(p - (const char *)lex->buf);
        return 0;
    }
    rc = rad_lex_word(lex, "a real argument", err);
    if (rc)
        return rc;
    if (!rad_read_real(lex->word, x))
        return rad_fail(err, RAD_EDATA, "expected a real argument, got '%s'",
                        lex->word);
    if (!isfinite(*x))
        return rad_fail(err, RAD_EDATA, "number '%s' is too large", lex->word);
    return 0;
}

int
rad_lex_line(struct rad_lex *lex, char *buf, size_t size, struct rad_error *err)
{
    size_t n = 0;
    int c;

    while ((c = next(lex, err)) != END) {
        if (c == '\r' && peek(lex, err) == '\n')
            continue;
        if (c == '\n' && (n == 0 || buf[n - 1] != '\\'))
            break;
        if (n + 1 == size)
            return rad_fail(err, RAD_EDATA, "command of more than %zu bytes",
                            size - 1);
        buf[n++] = (char)c;
    }
    buf[n] = '\0';
    return lex->rc;
}
