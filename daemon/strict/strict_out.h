/* strict_out.h - queues of messages of the strict units
 *
 * An item has a copy of what its message says.  Facts are not copied: the
 * message has those that there are when it is sent. */
#ifndef DAEMON_STRICT_OUT_H
#define DAEMON_STRICT_OUT_H

#include "strict/strict_state.h"

void out_release(struct strict *s);
/* Queue the facts of a line that were not sent. */
void out_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
               int line);
/* Queue, as urgent, those of a line's base line alone: the worker of the unit
 * below has no use for the bar. */
void out_base_facts(struct strict *s, const struct strict_unit *u, int line);
/* Queue the densities after a line, and how many lines they follow from. */
void out_guess(struct strict *s, const struct strict_unit *u, int line,
               int known, const uint8_t *density);
/* Queue GAVE: the unit keeps its lines before `last`. */
void out_gave(struct strict *s, const struct strict_unit *u, int last);
/* Queue PARKED, RESUMED or PAID. */
void out_state(struct strict *s, enum item_kind kind,
               const struct strict_unit *u);
/* Queue the time of each line of a unit or loan that is done. */
void out_line_costs(struct strict *s, const struct strict_unit *u);
void out_loan(struct strict *s, const struct strict_unit *u,
              const struct team_loan *loan);
/* Queue the part of a pass's bottom that was not sent. */
void out_piece(struct strict *s, const struct strict_pass *p,
               const struct team_bottom *b);
/* Queue a unit's whole bottom; before all other messages if the unit below is
 * at another worker. */
void out_bottom(struct strict *s, const struct strict_unit *u,
                const struct rad_pixel *pixels, const uint8_t *density);
/* Drop the lazy facts of a unit, which no worker needs any more. */
void out_forget(struct strict *s, const struct strict_unit *u);

#endif
