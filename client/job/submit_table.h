/* submit_table.h - radsubmit's own options: names, values, help
 *
 * A new option is a row of the table in submit_table.c, a field of struct
 * submit_options, and where it excludes others a line in submit_check.c. */
#ifndef RADD_CLIENT_SUBMIT_TABLE_H
#define RADD_CLIENT_SUBMIT_TABLE_H

#include "job/submit_options.h"
#include "base/error.h"

#include <stdio.h>

/* Take the option argv[0] and its value, which may be argv[1] (NULL behind the
 * last word), into *o: one of ours, or one of rpict's that name files.  Returns
 * the words used, 0 for an option that the table lacks, or a negative code. */
int submit_table_take(struct submit_options *o, char *const argv[],
                      struct rad_error *err);

/* --help. */
void submit_table_help(FILE *to);

#endif
