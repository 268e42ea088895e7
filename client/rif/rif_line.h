/* rif_line.h - a command line of radsubmit, of the variables of a .rif file
 *
 * Words lie in the file's arena.
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_LINE_H
#define RADD_CLIENT_RIF_LINE_H

#include "rif/rif_rules.h"
#include "show/picfile.h"

struct rif_line {
    struct rif *rif;
    char **list; /* n words */
    int n, room;
    const char *optfile; /* what rad would have in OPTFILE: an option a line */
    struct rad_error *err; /* gets what failed in any of these functions */
};

/* Append words, which are not copied; NULL stands for memory that a caller did
 * not get.  RAD_ENOMEM. */
int rif_line_add(struct rif_line *l, const char *word);
int rif_line_words(struct rif_line *l, char *const *words, int n);

/* The options of all views: RESOLUTION, QUALITY, render, REPORT...
 *   rules  those that rad makes of what the scene is like are among them
 *   raw    the picture is what rpict makes, neither filtered nor made smaller
 * Sets l->optfile.  RAD_EDATA, RAD_ENOMEM. */
int rif_line_options(struct rif_line *l, const struct rif_zone *z, bool rules,
                     bool raw);

/* PICTURE, or root in its place, and ZFILE, with "%s" for a view's name.
 * RAD_ENOMEM. */
int rif_line_outputs(struct rif_line *l, const char *root,
                     enum picfile_format as);

#endif
