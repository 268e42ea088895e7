/* rif_line.h - make a command line of radsubmit from a variable file
 *
 * The words are in the file's arena.
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_LINE_H
#define RADD_CLIENT_RIF_LINE_H

#include "rif/rif_rules.h"
#include "show/picfile.h"

struct rif_line {
    struct rif *rif;
    char **list; /* n words */
    int n, room;
    const char *optfile;   /* for OPTFILE, as rad has it: an option a line */
    struct rad_error *err; /* set by the functions below that fail */
};

/* Append words, without copying them.  A NULL word means that the caller found
 * no memory.  RAD_ENOMEM. */
int rif_line_add(struct rif_line *l, const char *word);
int rif_line_words(struct rif_line *l, char *const *words, int n);

/* Append the options that all views share: RESOLUTION, QUALITY, render,
 * REPORT...
 *   rules  add the options that rad derives from the scene's description
 *   raw    the picture is rpict's, neither filtered nor reduced
 * Sets l->optfile.  RAD_EDATA, RAD_ENOMEM. */
int rif_line_options(struct rif_line *l, const struct rif_zone *z, bool rules,
                     bool raw);

/* Append -o with PICTURE's value, or root if it has none, and -z with ZFILE's;
 * "%s" in them stands for a view's name.  RAD_ENOMEM. */
int rif_line_outputs(struct rif_line *l, const char *root,
                     enum picfile_format as);

#endif
