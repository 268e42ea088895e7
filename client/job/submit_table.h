/* submit_table.h - radsubmit's own options: names, values, help
 *
 * To add an option add a row to the table in submit_table.c, a field to struct
 * submit_options and, if it excludes others, a rule to submit_pairs.c. */
#ifndef RADD_CLIENT_SUBMIT_TABLE_H
#define RADD_CLIENT_SUBMIT_TABLE_H

#include "job/submit_options.h"
#include "base/error.h"

#include <stdio.h>

/* Take the option argv[0] and its value, which may be argv[1] (NULL after the
 * last word): one of our own, or one of rpict's that name files.  Returns the
 * number of words used, 0 if the tables lack the option, or a negative code. */
int submit_table_take(struct submit_options *o, char *const argv[],
                      struct rad_error *err);

/* Print --help. */
void submit_table_help(FILE *to);

#endif
