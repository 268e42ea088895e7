/* words.h - a command line whose @file and $VARIABLE words open up in place
 *
 * As in rpict(1): a word "@file" where an option may stand is replaced by the
 * blank-separated words of that file, "$NAME" by those of an environment
 * variable; what comes out is looked at again.  In a file a word that
 * begins with '#' ends its line.  Values of options are never
 * replaced, so the parser says where it stands.
 * Thread: one.  */
#ifndef RADD_CLIENT_WORDS_H
#define RADD_CLIENT_WORDS_H

#include "base/arena.h"
#include "base/error.h"
#include "common/inputs.h"

struct words {
    struct rad_arena arena; /* of list and of the text that came in */
    char **list;            /* n words and a NULL */
    int n, room;
    int expanded;         /* replacements so far */
    struct inputs inputs; /* files that were read, by whoever takes the words,
                           * too */
};

/* Copy argv[1..argc-1], without opening any.  RAD_ENOMEM. */
int words_init(struct words *w, int argc, char *const argv[],
               struct rad_error *err);
void words_release(struct words *w);

/* Replace the word at `at` (0 <= at < n) for as long as it begins with '@' or
 * '$'; what it stands for may be nothing, so w->n may become at.
 * RAD_ENOINPUT for a file that cannot be read, RAD_EUSAGE for a variable that
 * is not set, a file that is too long or one that names itself. */
int words_expand(struct words *w, int at, struct rad_error *err);

/* The place of the word in words, "a|b|c"; -1: it is none of them. */
int words_place(const char *words, const char *word);

#endif
