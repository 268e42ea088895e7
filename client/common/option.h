/* option.h - options of a command line, from a table
 *
 * A table has a row for each option: its name, the kind of its value, the field
 * of the program's struct that it sets, and its text for --help.
 * The value follows a '=' behind a name with two dashes, or is the next word.
 * Thread: any. */
#ifndef RADD_CLIENT_OPTION_H
#define RADD_CLIENT_OPTION_H

#include "base/error.h"

#include <stddef.h>
#include <stdio.h>

enum option_kind {
    OPTION_FLAG,  /* bool */
    OPTION_TEXT,  /* const char * */
    OPTION_MAYBE, /* as OPTION_TEXT; "" if no '=' follows */
    OPTION_INT,   /* int, lo..hi */
    OPTION_REAL,  /* double, lo..hi */
    OPTION_WORD   /* int: index of the word in `words` */
};

struct option {
    const char *name;
    enum option_kind kind;
    size_t field;    /* its offset in the struct */
    const char *arg; /* name of the value in --help; NULL: it takes none */
    const char *help;
    double lo, hi;
    const char *words; /* for OPTION_WORD: "auto|window" */
    const char *with;  /* for the program: what the option goes with */
};

/* The row of the option that the word is or begins with; NULL: there is none.
 */
const struct option *option_find(const struct option *table, size_t n,
                                 const char *word);

/* Take the option argv[0] of that row, and its value, which may be argv[1]
 * (NULL after the last word), into the struct.  Returns the number of words
 * used, or RAD_EUSAGE. */
int option_take(const struct option *o, void *to, char *const argv[],
                struct rad_error *err);

/* Print the rows for --help. */
void option_help(const struct option *table, size_t n, FILE *to);

#endif
