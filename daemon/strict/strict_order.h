/* strict_order.h - what a strict unit does that waits, goes back or goes away */
#ifndef DAEMON_STRICT_ORDER_H
#define DAEMON_STRICT_ORDER_H

#include "strict/strict_unit.h"

/* Forget a unit that has no pass, its facts and the messages about it. */
void order_drop(struct strict *s, struct strict_unit *u);
/* Give away half of the lines that have no bars yet, of a unit that no team is
 * at. */
void order_split_idle(struct strict *s, struct strict_unit *u);
/* Give back a unit that has no pass, and forget it: its facts that were not sent
 * are, so the next worker traces none of them again. */
void order_hand_back(struct strict *s, struct strict_unit *u);
/* Take the lines from `last` on from the unit, and send GAVE. */
void order_give_lines(struct strict *s, struct strict_unit *u, int last);
/* If the unit made the base line above, send its facts: another worker may wait
 * for them. */
void order_say_top(struct strict *s, const struct strict_unit *u);
/* A pass of the unit begins: the unit is parked no more. */
void order_resume(struct strict *s, struct strict_unit *u);
/* If the unit can only wait, send PARKED at once: the worker has room for
 * another unit. */
void order_park(struct strict *s, struct strict_unit *u);

#endif
