/* strict_rank.h - which strict unit comes first */
#ifndef DAEMON_STRICT_RANK_H
#define DAEMON_STRICT_RANK_H

#include "strict/strict_unit.h"

/* Can the unit only wait, for its top or for columns that it lent? */
bool rank_waits(const struct strict *s, const struct strict_unit *u);
/* Something more urgent came to do: tell the least urgent pass on a guess to
 * stop. */
void rank_make_way(struct strict *s);
/* The unit whose pass should be begun next, and the rank of that pass; NULL:
 * none. */
struct strict_unit *rank_choose(const struct strict *s, enum strict_rank *rank);

#endif
