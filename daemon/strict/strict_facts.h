/* strict_facts.h - facts of strict units, by frame and line
 *
 * Thread: teams read facts, and put new ones into them, without the machine's
 * lock; facts of lines that a pass is at stay. */
#ifndef DAEMON_STRICT_FACTS_H
#define DAEMON_STRICT_FACTS_H

#include "strict/strict_unit.h"

/* The facts of a line; NULL: there are none. */
struct rad_facts *facts_at(const struct strict *s, uint32_t frame, int line);
/* Allocate the table of a frame's facts by line, in which teams find facts that
 * arrive; the facts of all lines of a unit.  False: memory is out. */
bool facts_make_table(struct strict *s, uint32_t frame);
bool facts_make_all(struct strict *s, const struct strict_unit *u);
/* If facts of the base line above are here, the unit's first bar can be traced
 * ahead: note it. */
void facts_use_above(struct strict *s, struct strict_unit *u);
/* Free the facts of a line, if no unit needs them. */
void facts_drop(struct strict *s, uint32_t frame, int line);
/* Free the table of a frame that is done, if there are many frames. */
void facts_drop_table(struct strict *s, uint32_t frame);
/* How many facts of a unit are lost with the unit, being sent to nobody; how
 * many no row needed, those of a top made in vain among them. */
uint64_t facts_untold(const struct strict *s, const struct strict_unit *u);
uint64_t facts_unused(const struct strict *s, const struct strict_unit *u);
/* How many facts of a loan's line another worker had traced first; 0 if this
 * child has a unit of that line, which counts them. */
uint64_t facts_late(const struct strict *s, const struct strict_unit *u);
void facts_release(struct strict *s);

#endif
