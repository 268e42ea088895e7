/* strict_loan.h - columns of strict units that are lent or borrowed */
#ifndef DAEMON_STRICT_LOAN_H
#define DAEMON_STRICT_LOAN_H

#include "strict/strict_unit.h"

/* Are columns of the unit lent? */
bool loan_is_out(const struct strict_unit *u);
/* Forget which columns of the unit are lent. */
void loan_forget(struct strict_unit *u);
/* The unit has another last line now, of which none was lent. */
void loan_of_other_line(struct strict_unit *u);
/* Forget LEND: no column is left to lend. */
void loan_nothing_left(struct strict_unit *u);
/* Borrowed columns are traced, or are given back: send their facts, and PAID.
 */
void loan_end(struct strict *s, struct strict_unit *u);

#endif
