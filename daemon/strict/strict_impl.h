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
/* Room to count what the unit's lines cost; false: memory is out. */
bool strict_unit_count_lines(struct strict_unit *u);
/* Keep the most pixels that a pass of the unit has gone over. */
void strict_unit_made(struct strict_unit *u, const struct team_made *made);
bool strict_unit_has_top(const struct strict *s, const struct strict_unit *u);
/* The unit here whose bottom is this one's top, or the other way round; NULL:
 * none. */
struct strict_unit *strict_unit_above(const struct strict *s,
                               const struct strict_unit *u);
struct strict_unit *strict_unit_below(const struct strict *s,
                               const struct strict_unit *u);
/* Put a unit among those of its first line, or of the line after its last; or
 * take it out, before that line changes. */
void strict_unit_link_first(struct strict *s, struct strict_unit *u);
void strict_unit_link_last(struct strict *s, struct strict_unit *u);
void strict_unit_unlink_first(struct strict *s, struct strict_unit *u);
void strict_unit_unlink_last(struct strict *s, struct strict_unit *u);
void strict_unit_free_loan(struct loan *l);
/* Forget what the unit's bottom was guessed to be. */
void strict_unit_free_guess(struct strict_unit *u);

/* --- strict_unit.c --- */

/* Forget a unit that has no pass, its facts and the messages about it. */
void strict_unit_drop(struct strict *s, struct strict_unit *u);
/* Give half of a unit that no team is at, or all of it: then it is gone. */
void strict_unit_split_idle(struct strict *s, struct strict_unit *u);
void strict_unit_hand_back(struct strict *s, struct strict_unit *u);
/* Lines from `last` on are no longer the unit's; say so. */
void strict_unit_give_lines(struct strict *s, struct strict_unit *u, int last);
/* Send what others may wait for of the base line above. */
void strict_unit_say_top(struct strict *s, const struct strict_unit *u);
/* A pass of the unit begins: it is parked no more. */
void strict_unit_resume(struct strict *s, struct strict_unit *u);
/* Say at once that the unit can only wait, if so: the worker has room for
 * another unit. */
void strict_unit_park(struct strict *s, struct strict_unit *u);

/* --- strict_loan.c --- */

/* Are columns of the unit lent? */
bool loan_is_out(const struct strict_unit *u);
/* What it lends is not its affair any more; its last line is another now;
 * nothing of it is left to lend. */
void loan_forget(struct strict_unit *u);
void loan_of_other_line(struct strict_unit *u);
void loan_nothing_left(struct strict_unit *u);
/* What another worker lends is traced, or goes back: its lender gets it. */
void loan_end(struct strict *s, struct strict_unit *u);

/* --- strict_rank.c --- */

/* Can the unit do nothing but wait for its top? */
bool rank_waits(const struct strict *s, const struct strict_unit *u);
/* What others wait for is due: have a thread leave what is less urgent. */
void rank_make_way(struct strict *s);
/* The unit that a thread should begin with, and for what; NULL: none. */
struct strict_unit *rank_choose(const struct strict *s, enum strict_rank *rank);
/* Is the unit's bottom, which others may wait for, still to be made? */
bool rank_owes_bottom(const struct strict *s, const struct strict_unit *u);
/* Is the base line above the unit gone over ahead, too? */
bool rank_goes_above(const struct strict_unit *u);

/* --- strict_facts.c --- */

/* NULL: there are none. */
struct rad_facts *facts_at(const struct strict *s, uint32_t frame, int line);
/* Room for the facts of a frame's lines; teams look there for new ones.  False:
 * memory is out, here and below. */
bool facts_make_table(struct strict *s, uint32_t frame);
bool facts_make_all(struct strict *s, const struct strict_unit *u);
/* Are there facts of each of the unit's lines? */
bool facts_have_all(const struct strict *s, const struct strict_unit *u);
/* The unit's first bar can be traced ahead if there are such of the base line
 * above. */
void facts_use_above(struct strict *s, struct strict_unit *u);
/* Free those of a line, if nobody needs them. */
void facts_drop(struct strict *s, uint32_t frame, int line);
/* With many frames, do not keep what those that are done had. */
void facts_drop_table(struct strict *s, uint32_t frame);
/* Facts of a unit that go with it, and nobody was told of; and those of its
 * lines that are there for nothing, with the top that it made in vain. */
uint64_t facts_untold(const struct strict *s, const struct strict_unit *u);
uint64_t facts_unused(const struct strict *s, const struct strict_unit *u);
/* What another worker had traced first of a loan's line; counted here if no
 * unit of that line is. */
uint64_t facts_late(const struct strict *s, const struct strict_unit *u);
void facts_release(struct strict *s);

/* --- strict_edge.c --- */

struct edge *edge_find(const struct strict *s, uint32_t frame, int line);
/* NULL: memory is out. */
struct edge *edge_make(struct strict *s, uint32_t frame, int line);
/* Free it, if no unit needs it. */
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
/* Send the facts of a line that are new, once. */
void out_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
               int line);
/* Lines before `last` are left of it. */
void out_gave(struct strict *s, const struct strict_unit *u, int last);
void out_parked(struct strict *s, const struct strict_unit *u);
void out_resumed(struct strict *s, const struct strict_unit *u);
void out_paid(struct strict *s, const struct strict_unit *u);
/* What was spent on each line for a unit or loan that is done. */
void out_line_costs(struct strict *s, const struct strict_unit *u);
void out_loan(struct strict *s, const struct strict_unit *u,
              const struct team_loan *loan);
/* What is new of the bottom of a pass. */
void out_piece(struct strict *s, const struct strict_pass *p, int columns,
               size_t densities, const struct rad_pixel *pixels,
               const uint8_t *density);
/* All of a unit's bottom; first of all where nobody here waits for it. */
void out_bottom(struct strict *s, const struct strict_unit *u,
                const struct rad_pixel *pixels, const uint8_t *density);
/* Nobody needs the facts of a parked unit any more. */
void out_forget(struct strict *s, const struct strict_unit *u);

#endif
