/* strict_rank.h - which strict unit comes first */
#ifndef DAEMON_STRICT_RANK_H
#define DAEMON_STRICT_RANK_H

#include "strict/strict_unit.h"

/* Can the unit do nothing but wait for its top? */
bool rank_waits(const struct strict *s, const struct strict_unit *u);
/* Where a more urgent pass is due than one under way, have a thread leave the
 * latter. */
void rank_make_way(struct strict *s);
/* The unit that a thread should begin with, and the rank of its pass; NULL:
 * none. */
struct strict_unit *rank_choose(const struct strict *s, enum strict_rank *rank);
/* Do passes ahead make the base line above the unit, too? */
bool rank_goes_above(const struct strict_unit *u);

#endif
