/* lex.h - words of scene text
 *
 * Words are separated by white space.  Quotes, single or double, keep white
 * space in a word, and may begin anywhere in it (a"b c"d is one word); between
 * them the other kind is an ordinary character.  Comments go from '#' to the
 * end of the line.  They may begin before an object, before its type, and
 * before any number; as a name or a string argument "#4" is a word, as in
 * Radiance.  Text is read from a struct rad_stream as it comes, such as the
 * output of a command.
 * Thread: a lexer belongs to one thread. */
#ifndef RAD_SCENE_LEX_H
#define RAD_SCENE_LEX_H

#include "base/error.h"
#include "base/files.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

#define RAD_MAX_COMMAND 65535 /* bytes of a command with its continuations */

struct rad_lex {
    struct rad_stream in;
    int line; /* of the next character, 1-based */
    int rc;   /* first failure of the stream, or 0 */
    bool eof;
    size_t pos, len;                  /* [pos, len) of buf is not read yet */
    char word[RAD_MAX_WORD + 1];      /* the last word */
    unsigned char buf[64 * 1024 + 1]; /* buf[len] is NUL; text has no NULs */
};

enum rad_token {
    RAD_TOKEN_END, /* of the text */
    RAD_TOKEN_WORD,
    RAD_TOKEN_COMMAND /* '!', which is skipped */
};

void rad_lex_init(struct rad_lex *lex, const struct rad_stream *in);

/* Skip white space and comments; returns the kind of token that is next.  Only
 * here does '!' start a command.  Negative code: the text cannot be read. */
int rad_lex_next(struct rad_lex *lex, struct rad_error *err);

/* Read a word into lex->word.  `what` names the expected word for messages.
 * RAD_EDATA: the text ends, the word is too long, or a quote is not closed. */
int rad_lex_word(struct rad_lex *lex, const char *what, struct rad_error *err);

/* Skip comments, then read a word that is a number: an integer of 0 to max, or
 * a finite real as Radiance writes it (digits, '.', exponent; no hexadecimal,
 * infinity or NaN). */
int rad_lex_count(struct rad_lex *lex, const char *what, int max, int *n,
                  struct rad_error *err);
int rad_lex_real(struct rad_lex *lex, double *x, struct rad_error *err);

/* Read the rest of the line into buf, NUL-terminated.  A backslash before the
 * newline continues it; both are kept, for the shell. */
int rad_lex_line(struct rad_lex *lex, char *buf, size_t size,
                 struct rad_error *err);

#endif
