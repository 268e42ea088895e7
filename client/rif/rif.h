/* rif.h - read rad's variable files
 *
 * A line is "NAME= value".  A name may be abbreviated to its first two or three
 * letters.  A backslash takes the next character literally, and joins a line
 * with the next one; '#' begins a comment.  Some variables have one value, the
 * last that is assigned; for some all values are added up; each `view` counts
 * by itself.  rifjob.h interprets the values.
 * Source: rad(1).
 * Thread: one. */
#ifndef RADD_CLIENT_RIF_H
#define RADD_CLIENT_RIF_H

#include "base/arena.h"
#include "base/error.h"

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
    const char *text; /* not empty, without blanks at its ends */
    int line;         /* 0: from the command line */
};

struct rif {
    struct rad_arena arena;
    const char *name; /* of the file */
    struct rif_value *first[RIF_VARS], *last[RIF_VARS];
    int nvalues;
};

/* Parse the file's text, of len bytes; name must outlive *r.  RAD_EDATA with
 * the line; RAD_ENOMEM.  *r can be released in any case. */
int rif_parse(struct rif *r, const char *name, const char *text, size_t len,
              struct rad_error *err);
void rif_release(struct rif *r);

/* Take an assignment of the command line.  RAD_EUSAGE. */
int rif_assign(struct rif *r, const char *assignment, struct rad_error *err);

/* Check that each variable's value is of its kind.  RAD_EDATA. */
int rif_check(const struct rif *r, struct rad_error *err);

const char *rif_variable(enum rif_var v);

/* A variable's one value, without quotes around it; NULL: it has none. */
const char *rif_text(struct rif *r, enum rif_var v);

/* The first letter of the value, in upper case; `none` if there is no value. */
char rif_letter(const struct rif *r, enum rif_var v, char none);

/* The words of all values of a variable, or of a text, split as by a shell: in
 * '' all characters are literal; elsewhere a backslash takes the next one.
 * *words: a list that ends with NULL, in the arena.  Returns the number of
 * words.  RAD_EDATA: a quote has no end; RAD_ENOMEM. */
int rif_words(struct rif *r, enum rif_var v, char ***words,
              struct rad_error *err);
int rif_split(struct rif *r, const char *text, char ***words,
              struct rad_error *err);

/* Fail because of the variable's last value: "room.rif:3: ZONE: ...". */
int rif_fail(const struct rif *r, enum rif_var v, struct rad_error *err,
             const char *what);

#endif
