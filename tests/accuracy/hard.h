/* hard.h - cases that break renderers, each with a number */
#ifndef RADD_TESTS_HARD_H
#define RADD_TESTS_HARD_H

#include "stage.h"

struct hard_row {
    const char *name;
    /* Returns what is counted or measured.  May open the stage, which the
     * caller closes. */
    double (*measure)(struct stage *s, const double *a);
    double a[3];
    double most; /* allowed */
};

extern const struct hard_row hard_rows[], bounce_rows[]; /* ends with one without a name */

#endif
