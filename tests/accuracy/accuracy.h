/* accuracy.h - the table of closed forms
 *
 * Each row measures something whose truth is a formula.  Rows that differ in
 * numbers alone share a function. */
#ifndef RADD_TESTS_ACCURACY_H
#define RADD_TESTS_ACCURACY_H

#include "stage.h"

struct outcome {
    double found, truth;
};

struct row {
    const char *name;
    /* Opens the stage, which the caller closes. */
    struct outcome (*measure)(struct stage *s, const double *a);
    double a[5];
    double tolerance; /* largest relative error allowed */
};

/* Each ends with a row without a name. */
extern const struct row light_rows[], sky_rows[], matter_rows[];

#endif
