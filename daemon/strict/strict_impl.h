/* strict_impl.h - what the files of the strict units' machine share
 *
 * Private to strict*.c:
 *   strict.c        set-up and end
 *   strict_pass.c   the next pass: of which unit, in which mode
 *   strict_unit.c   messages about units: UNIT, SPLIT, YIELD, REVOKE
 *   strict_loan.c   columns that are lent, and that others lend
 *   strict_rank.c   which unit comes first
 *   strict_out.c    messages that go out
 *   strict_facts.c  facts by line
 *   strict_units.c  tables of states; units by number and by line
 *   strict_edge.c   tops and bottoms by line
 * A file calls files below it in this list alone. */
#ifndef DAEMON_STRICT_IMPL_H
#define DAEMON_STRICT_IMPL_H

#include "strict/strict_state.h"

/* --- strict_units.c --- */

/* Change the unit's progress or fate; the step must be in strict_progress_steps
 * or strict_fate_steps.  Called by the files of this folder alone. */
void strict_unit_advance(struct strict_unit *u, enum strict_progress to);
void strict_unit_decide(struct strict_unit *u, enum strict_fate to);
/* The first line that the unit makes: its own first, or the base line above. */
int strict_unit_top(const struct strict_unit *u);
/* The unit of that number and attempt that is not gone; NULL: none. */
struct strict_unit *strict_unit_find(const struct strict *s, uint32_t unit,
                                     uint32_t attempt);
void strict_unit_free(struct strict_unit *u);
/* Allocate the counters of the lines' costs; false: memory is out. */
bool strict_unit_count_lines(struct strict_unit *u);
/* Keep the most pixels that a pass of the unit has gone over. */
void strict_unit_made(struct strict_unit *u, const struct team_made *made);
bool strict_unit_has_top(const struct strict *s, const struct strict_unit *u);
/* The unit of this child whose bottom is u's top; whose top is u's bottom.
 * NULL: none. */
struct strict_unit *strict_unit_above(const struct strict *s,
                                      const struct strict_unit *u);
struct strict_unit *strict_unit_below(const struct strict *s,
                                      const struct strict_unit *u);
/* Enter a unit in the table by its first line, or by the line after its last;
 * take it out of the table, before that line changes. */
void strict_unit_link_first(struct strict *s, struct strict_unit *u);
void strict_unit_link_last(struct strict *s, struct strict_unit *u);
void strict_unit_unlink_first(struct strict *s, struct strict_unit *u);
void strict_unit_unlink_last(struct strict *s, struct strict_unit *u);
void strict_unit_free_loan(struct loan *l);
/* Forget the guess at the unit's bottom. */
void strict_unit_free_guess(struct strict_unit *u);

/* --- strict_unit.c --- */

/* Forget a unit that has no pass, its facts and the messages about it. */
void strict_unit_drop(struct strict *s, struct strict_unit *u);
/* Give away half of the lines that have no bars yet, of a unit that no team is
 * at. */
void strict_unit_split_idle(struct strict *s, struct strict_unit *u);
void strict_unit_hand_back(struct strict *s, struct strict_unit *u);
/* Take the lines from `last` on from the unit, and send GAVE. */
void strict_unit_give_lines(struct strict *s, struct strict_unit *u, int last);
/* If the unit made the base line above, send its facts: another worker may wait
 * for them. */
void strict_unit_say_top(struct strict *s, const struct strict_unit *u);
/* A pass of the unit begins: the unit is parked no more. */
void strict_unit_resume(struct strict *s, struct strict_unit *u);
/* If the unit can only wait, send PARKED at once: the worker has room for
 * another unit. */
void strict_unit_park(struct strict *s, struct strict_unit *u);

/* --- strict_loan.c --- */

/* Are columns of the unit lent? */
bool loan_is_out(const struct strict_unit *u);
/* Forget the columns that the unit lends; its last line is another from now on;
 * no column is left to lend. */
void loan_forget(struct strict_unit *u);
void loan_of_other_line(struct strict_unit *u);
void loan_nothing_left(struct strict_unit *u);
/* Borrowed columns are traced, or go back: send the lender their facts. */
void loan_end(struct strict *s, struct strict_unit *u);

/* --- strict_rank.c --- */

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

/* --- strict_facts.c --- */

/* The facts of a line; NULL: there are none. */
struct rad_facts *facts_at(const struct strict *s, uint32_t frame, int line);
/* Allocate the table of a frame's facts by line, in which teams find facts that
 * arrive; the facts of all lines of a unit.  False: memory is out. */
bool facts_make_table(struct strict *s, uint32_t frame);
bool facts_make_all(struct strict *s, const struct strict_unit *u);
/* Are there facts of each of the unit's lines? */
bool facts_have_all(const struct strict *s, const struct strict_unit *u);
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

/* --- strict_edge.c --- */

struct edge *edge_find(const struct strict *s, uint32_t frame, int line);
/* NULL: memory is out. */
struct edge *edge_make(struct strict *s, uint32_t frame, int line);
/* Free the edge of a line, if no unit needs it. */
void edge_drop(struct strict *s, uint32_t frame, int line);
/* The line was made here, and is whole; false: memory is out. */
bool edge_set(struct strict *s, struct edge *e, const struct rad_pixel *pixels,
              const uint8_t *density);
/* A piece that fits came.  True: it makes the line whole. */
bool edge_put(struct strict *s, struct edge *e, const struct msg_base_line *m);
/* Of the lines of a frame. */
struct shelf_size edge_size(const struct strict *s, uint32_t frame);
void edge_release(struct strict *s);

/* --- strict_out.c --- */

void out_release(struct strict *s);
/* Send the facts of a line that have not been sent. */
void out_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
               int line);
/* Send GAVE: the unit keeps its lines before `last`. */
void out_gave(struct strict *s, const struct strict_unit *u, int last);
void out_parked(struct strict *s, const struct strict_unit *u);
void out_resumed(struct strict *s, const struct strict_unit *u);
void out_paid(struct strict *s, const struct strict_unit *u);
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
