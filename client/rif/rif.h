/* rif.h - rad's variable files: what is assigned to what, and where
 *
 * A line is "NAME= value"; a name may be cut short to its first two or three
 * letters, a backslash takes the next character, or the line's end, as it is,
 * and '#' begins a comment.  Some variables have one value, the last that is
 * assigned; some add theirs up; each `view` is one of its own.  What the
 * values mean is for rifjob.h to say.
 * Source: rad(1).
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_H
#define RADD_CLIENT_RIF_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>

enum rif_var { /* in the order of the table in rif.c */
               RIF_AMBFILE,
               RIF_DETAIL,
               RIF_EXPOSURE,
               RIF_EYESEP,
               RIF_ILLUM,
               RIF_INDIRECT,
               RIF_MATERIALS,
               RIF_MKILLUM,
               RIF_MKPMAP,
               RIF_OBJECTS,
               RIF_OCONV,
               RIF_OCTREE,
               RIF_OPTFILE,
               RIF_PCMAP,
               RIF_PENUMBRAS,
               RIF_PFILT,
               RIF_PGMAP,
               RIF_PICTURE,
               RIF_QUALITY,
               RIF_RAWFILE,
               RIF_RENDER,
               RIF_REPORT,
               RIF_RESOLUTION,
               RIF_RPICT,
               RIF_RVU,
               RIF_SCENE,
               RIF_UP,
               RIF_VARIABILITY,
               RIF_VIEW,
               RIF_ZFILE,
               RIF_ZONE,
               RIF_VARS
};

enum { RIF_MAX_BYTES = 1 << 20, RIF_MAX_VALUES = 10000 };

struct rif_value {
    struct rif_value *next;
    const char *text; /* not empty; no blank at its ends */
    int line;         /* 0: of the command line */
};

struct rif {
    struct rad_arena arena;
    const char *name; /* of the file */
    struct rif_value *first[RIF_VARS], *last[RIF_VARS];
    int nvalues;
};

/* Take the file's text, len bytes; name outlives *r.  RAD_EDATA with the line,
 * RAD_ENOMEM; *r can be released then too. */
int rif_parse(struct rif *r, const char *name, const char *text, size_t len,
              struct rad_error *err);
void rif_release(struct rif *r);

/* One more assignment, of the command line.  RAD_EUSAGE. */
int rif_assign(struct rif *r, const char *assignment, struct rad_error *err);

/* Is each value of its variable's kind?  RAD_EDATA. */
int rif_check(const struct rif *r, struct rad_error *err);

const char *rif_variable(enum rif_var v);

/* The one value of a variable, without quotes around it; NULL: none. */
const char *rif_text(struct rif *r, enum rif_var v);

/* The value's first letter in upper case; `none` without a value. */
char rif_letter(const struct rif *r, enum rif_var v, char none);

/* The words of all its values, or of one text, as a shell would part them: in
 * '' as they are, in "" and outside of both a backslash takes the next
 * character.  *words gets a list with a NULL at its end, of the arena; returns
 * how many.  RAD_EDATA for a quote without its end, RAD_ENOMEM. */
int rif_words(struct rif *r, enum rif_var v, char ***words,
              struct rad_error *err);
int rif_split(struct rif *r, const char *text, char ***words,
              struct rad_error *err);

/* Record a failure about the variable's last value: "room.rif:3: ZONE: ...". */
int rif_fail(const struct rif *r, enum rif_var v, struct rad_error *err,
             const char *what);

#endif
