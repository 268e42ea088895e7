/* strict_facts.h - facts of strict units, by frame and line
 *
 * Thread: teams read facts and add to them without the machine's lock; facts of
 * lines that a pass works on are not freed. */
#ifndef DAEMON_STRICT_FACTS_H
#define DAEMON_STRICT_FACTS_H

#include "strict/strict_unit.h"

/* The facts of a line; NULL: it has none. */
struct rad_facts *facts_at(const struct strict *s, uint32_t frame, int line);
/* Make the table of a frame's facts by line, where teams find facts that come;
 * or facts of all lines of a unit.  False: memory is out. */
bool facts_make_table(struct strict *s, uint32_t frame);
bool facts_make_all(struct strict *s, const struct strict_unit *u);
/* If facts of the whole base line above are here, let the unit's first bar be
 * traced ahead. */
void facts_use_above(struct strict *s, struct strict_unit *u);
/* Free the facts of a line that no unit needs. */
void facts_drop(struct strict *s, uint32_t frame, int line);
/* Free a frame's table, if no unit and no facts of the frame are left. */
void facts_drop_table(struct strict *s, uint32_t frame);
/* How many facts are lost with the unit, because they were sent to no worker.
 */
uint64_t facts_untold(const struct strict *s, const struct strict_unit *u);
/* How many facts of the unit no row needed, with those of a base line above
 * that was made in vain. */
uint64_t facts_unused(const struct strict *s, const struct strict_unit *u);
/* How many facts of a borrowed line another worker had traced first; 0 if
 * another unit of this child has the line and counts them. */
uint64_t facts_late(const struct strict *s, const struct strict_unit *u);
void facts_release(struct strict *s);

#endif
