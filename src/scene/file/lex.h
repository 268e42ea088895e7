/* lex.h - the words of scene text
 *
 * Words are parted by white space.  Quotes, single or double, keep white space
 * in a word and may open anywhere in it (a"b c"d is one word); the other kind
 * is an ordinary character between them.  Comments go from '#' to the end of
 * the line.  They may start where no word can: before an object, before its
 * type, and before any number; as a name or a string argument, "#4" is a word,
 * as it is for Radiance.
 * Text is pulled from a struct rad_stream, so that the output of a command is
 * read as it comes.
 * Thread: a lexer belongs to one thread. */
#ifndef RAD_SCENE_LEX_H
#define RAD_SCENE_LEX_H

#include "base/error.h"
#include "base/files.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>

#define RAD_MAX_COMMAND 65535 /* bytes of a command line with continuations */

struct rad_lex {
    struct rad_stream in;
    int line; /* of the next character, 1-based */
    int rc;   /* first failure of the stream, or 0 */
    bool eof;
    size_t pos, len;                  /* what of buf is to be read yet */
    char word[RAD_MAX_WORD + 1];      /* the last word */
    unsigned char buf[64 * 1024 + 1]; /* buf[len] is NUL, which text has not */
};

enum rad_token {
    RAD_TOKEN_END, /* of the text */
    RAD_TOKEN_WORD,
    RAD_TOKEN_COMMAND /* '!', which is consumed */
};

void rad_lex_init(struct rad_lex *lex, const struct rad_stream *in);

/* Skip white space and comments; what comes next?  '!' counts as a command
 * here only.  Negative code: the text cannot be read. */
int rad_lex_next(struct rad_lex *lex, struct rad_error *err);

/* Read a word into lex->word; 0, or RAD_EDATA at the end of the text, for a
 * word that is too long or whose quote is not closed.  `what` names what is
 * expected, for the message. */
int rad_lex_word(struct rad_lex *lex, const char *what, struct rad_error *err);

/* Skip comments, then read a number that makes a whole word: an integer of
 * 0 to max, or a finite real as Radiance writes them (digits, '.', exponent;
 * no hexadecimal, infinity or NaN). */
int rad_lex_count(struct rad_lex *lex, const char *what, int max, int *n,
                  struct rad_error *err);
int rad_lex_real(struct rad_lex *lex, double *x, struct rad_error *err);

/* Read the rest of the line into buf, NUL-terminated; a backslash before the
 * newline continues it (both are kept: the shell knows them too). */
int rad_lex_line(struct rad_lex *lex, char *buf, size_t size,
                 struct rad_error *err);

#endif
