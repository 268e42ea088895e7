/* strict_guess.h - what a strict unit guesses at its top and its bottom
 *
 * Where its top is not there a unit is traced on a guess at the densities above
 * it; the more lines they follow from, the better the guess.  The densities of
 * the line above come from the unit above, if this child has it; else its
 * worker sends them (MSG_GUESS), and with better ones the lines are made again.
 * Passes record the densities that they made (struct strict_chain). */
#ifndef DAEMON_STRICT_GUESS_H
#define DAEMON_STRICT_GUESS_H

#include "strict/strict_unit.h"

/* Set the top of a pass: true, guessed, or the part that is known.  False:
 * memory is out. */
bool guess_top(struct strict *s, struct strict_pass *p);
/* Is more known of the unit's top than when its lines were last made? */
bool guess_is_better(const struct strict *s, const struct strict_unit *u);
/* Let the pass record its lines' densities; false: memory is out. */
bool guess_record(const struct strict *s, struct strict_pass *p);
/* The pass has left: keep the densities that it recorded and, if it is done,
 * its bottom as a guess for the unit below. */
void guess_keep(struct strict *s, struct strict_pass *p, bool done,
                const struct team_bottom *b);
/* Send the worker of the unit below the densities above the unit's last line,
 * if they are known better than those that were sent.  Facts of the last line
 * go before. */
void guess_send(struct strict *s, struct strict_unit *u);
/* Was the unit's bottom guessed from just these densities?  Then it is true: a
 * base line depends only on the densities above it. */
bool guess_holds(const struct strict *s, const struct strict_unit *u,
                 const uint8_t *density);

#endif
