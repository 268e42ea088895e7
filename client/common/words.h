/* words.h - a command line whose @file and $VARIABLE words are expanded
 *
 * As in rpict(1): where an option may stand, a word "@file" is replaced by the
 * words of that file, separated by blanks, and "$NAME" by those of an
 * environment variable; the new words are expanded, too.  In a file a word that
 * begins with '#' starts a comment, to the end of the line.  Values of options
 * are not expanded, so the parser says which word is to be.
 * Thread: one. */
#ifndef RADD_CLIENT_WORDS_H
#define RADD_CLIENT_WORDS_H

#include "base/arena.h"
#include "base/error.h"
#include "common/inputs.h"

struct words {
    struct rad_arena arena; /* has the list and all words */
    char **list;            /* n words and a NULL */
    int n, room;
    int expanded;         /* replacements so far */
    struct inputs inputs; /* files that were read; also noted by callers */
};

/* Copy argv[1..argc-1], without expanding.  RAD_ENOMEM. */
int words_init(struct words *w, int argc, char *const argv[],
               struct rad_error *err);
void words_release(struct words *w);

/* Expand the word at `at` (0 <= at < n) while it begins with '@' or '$'.  It
 * may become no word at all, so `at` may be w->n then.  RAD_ENOINPUT: a file
 * cannot be read; RAD_EUSAGE: a variable is not set, a file is too long or
 * names itself. */
int words_expand(struct words *w, int at, struct rad_error *err);

/* The index of word in words, "a|b|c"; -1: not among them. */
int words_place(const char *words, const char *word);

#endif
