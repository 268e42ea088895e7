/* strict_out.h - messages of the strict units that are queued to be sent
 *
 * What a message says is copied, but for facts, which are read as they are when
 * the message goes. */
#ifndef DAEMON_STRICT_OUT_H
#define DAEMON_STRICT_OUT_H

#include "strict/strict_state.h"

void out_release(struct strict *s);
/* Send the facts of a line that have not been sent. */
void out_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
               int line);
/* Send GAVE: the unit keeps its lines before `last`. */
void out_gave(struct strict *s, const struct strict_unit *u, int last);
/* Send PARKED, RESUMED or PAID. */
void out_state(struct strict *s, enum item_kind kind,
               const struct strict_unit *u);
/* Send the cost of each line of a unit or loan that is done. */
void out_line_costs(struct strict *s, const struct strict_unit *u);
void out_loan(struct strict *s, const struct strict_unit *u,
              const struct team_loan *loan);
/* Send the part of a pass's bottom that has not been sent. */
void out_piece(struct strict *s, const struct strict_pass *p, int columns,
               size_t densities, const struct rad_pixel *pixels,
               const uint8_t *density);
/* Send all of a unit's bottom; before all other messages if no unit of this
 * child waits for it. */
void out_bottom(struct strict *s, const struct strict_unit *u,
                const struct rad_pixel *pixels, const uint8_t *density);
/* Drop the queued facts of a parked unit: nobody needs them any more. */
void out_forget(struct strict *s, const struct strict_unit *u);

#endif
