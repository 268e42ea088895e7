/* strict_loan.h - columns of strict units that are lent */
#ifndef DAEMON_STRICT_LOAN_H
#define DAEMON_STRICT_LOAN_H

#include "strict/strict_unit.h"

/* Are columns of the unit lent? */
bool loan_is_out(const struct strict_unit *u);
/* Forget the columns that the unit lends; its last line is another from now on;
 * no column is left to lend. */
void loan_forget(struct strict_unit *u);
void loan_of_other_line(struct strict_unit *u);
void loan_nothing_left(struct strict_unit *u);
/* Borrowed columns are traced, or go back: send the lender their facts. */
void loan_end(struct strict *s, struct strict_unit *u);

#endif
