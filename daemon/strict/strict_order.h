/* strict_order.h - a strict unit waits, gives lines away, goes back or ends */
#ifndef DAEMON_STRICT_ORDER_H
#define DAEMON_STRICT_ORDER_H

#include "strict/strict_unit.h"

/* Drop a unit that has no pass, its facts and the lazy messages about it. */
void order_drop(struct strict *s, struct strict_unit *u);
/* Give away half of the lines that have no bars yet, of a unit without a pass.
 */
void order_split_idle(struct strict *s, struct strict_unit *u);
/* Give back a unit that has no pass, and drop it.  Its facts that were not sent
 * are sent before, so that the next worker need not trace them. */
void order_hand_back(struct strict *s, struct strict_unit *u);
/* Take the lines from `last` on from the unit, and send GAVE. */
void order_give_lines(struct strict *s, struct strict_unit *u, int last);
/* If the unit made the base line above, send the facts of that line: another
 * worker may wait for them. */
void order_say_top(struct strict *s, const struct strict_unit *u);
/* A pass of the unit begins, so it does not wait. */
void order_resume(struct strict *s, struct strict_unit *u);
/* If the unit can only wait, send PARKED: the worker has room for another unit.
 */
void order_park(struct strict *s, struct strict_unit *u);

#endif
