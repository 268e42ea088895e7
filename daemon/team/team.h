/* team.h - the threads that go over one unit together
 *
 * The unit is a run of lines of a sampler's area: a whole window, or some lines
 * of a frame that is sampled as one (a strict unit).  Line i stands for base
 * line i and the bar above it.  The pixels are those that a thread alone would
 * make, and the rays are the same: each member takes a line; it samples the
 * base line close behind the member on the line above, whose densities it
 * needs, then fills the bar.  So the members move across the area in echelon,
 * and the hand-off between two lines is a number in memory.
 *
 * What a unit needs from above is its top: the base line above its first line,
 * as in the picture (small sources painted), and the densities after it.  With
 * line 0 it needs none.  Its bottom is its last base line: the top of the unit
 * below.  A team makes one pass over the unit; a unit whose top comes late gets
 * several, each by a new team over the same facts (facts.h):
 *   TEAM_TRUTH  the top is true.  What is a fact is used, the rest is traced;
 *               rows are painted and handed on; the bottom is true.
 *   TEAM_LINES  the top is a guess.  Base lines are traced, into facts, and of
 *               the first lines the bars as well, as with AHEAD.
 *   TEAM_AHEAD  the top is a guess.  Base lines and bars, into facts.  Left
 *               out are a bar without colours above it (of the first line, if
 *               top is NULL), and, where little is known of the densities
 *               above, what the truth may not want: all of a bar but columns
 *               between two traced pixels.  (A base line that is sampled with
 *               too little density is a part of what the truth wants.)
 * The two last hand nothing on and paint nothing; their bottom is a guess, its
 * colours as they were sampled.  To make a base line for the unit above as well
 * (MSG_UNIT_TOP), begin LINES and AHEAD one line earlier, with no top: the
 * first line's bar is left out, all others have colours above.
 * Columns of the last line may be lent to another team while they are not begun
 * (team_lend()): a line is traced in blocks of columns, and each block is
 * either claimed by the member or lent.  AHEAD leaves out what is lent.  TRUTH
 * does all else, then the member leaves (team_blocked()), since rows go out
 * whole; once the columns are back another team goes over the facts.  LOAN is
 * the other end: those columns of one line, into facts.
 * A unit below that waits gets the bottom soonest by a pass of LINES first, the
 * top being true: with true_top the bottom is, too, and painted.  TRUTH then
 * goes over the facts.
 *
 * Knows no scene: pixels come from a callback, a pure function of its place.
 * Thread: team_work() from any number of threads at once; team_stop(),
 * team_open(), team_shrink(), team_lend(), team_back(), team_bottom(),
 * team_rays(), team_made() and team_waited() from any; the others while nobody
 * works.  Rows
 * are handed on by one member at a time. */
#ifndef RADD_DAEMON_TEAM_H
#define RADD_DAEMON_TEAM_H

#include "team/team_spec.h"

struct team;

/* NULL: memory is out. */
struct team *team_new(const struct team_spec *spec);
void team_free(struct team *t);

/* The rows of line i of a sampler's area: the first, and how many. */
int team_line_row(const struct rad_quincunx *q, int i);
int team_line_rows(const struct rad_quincunx *q, int i);

/* Work until there is no line left to begin, or the team is stopped. */
void team_work(struct team *t, struct rad_ctx *ctx);

/* Is there a line left for another member to begin? */
bool team_open(struct team *t);

/* End early: each member leaves within a few pixels. */
void team_stop(struct team *t);

/* Give away half (rounded up) of the lines that are not begun, the lower
 * ones, but none below `least`.  Returns `last` as it is from now on. */
int team_shrink(struct team *t, int least);

/* Nobody works any more: the unit ends with the lines whose rows were handed on
 * in this pass of TRUTH.  Returns `last` as it is from now on; -1: there are
 * none, and nothing changes. */
int team_cut(struct team *t);

/* Columns to a block, but the last. */
int team_block_columns(const struct rad_quincunx *q);

/* The blocks that columns [x, x + n) are in; none: they are no whole blocks. */
uint64_t team_blocks_of(const struct rad_quincunx *q, int x, int n);

/* Lend part (0 to 1) of what is not begun of the last line, or less; not with
 * LINES.  Others must not trace it until they have it back.  What loan points
 * to stays until team_free(); wanted is the caller's.  False: nothing. */
bool team_lend(struct team *t, double part, struct team_loan *loan);

/* Blocks of the last line that were lent are the team's again. */
void team_back(struct team *t, uint64_t blocks);

/* TRUTH: has a member left because columns are lent?  Rows of lines before
 * *finished were handed on. */
bool team_blocked(const struct team *t, int *finished);

/* The unit's bottom so far: columns [0, columns) and densities [0, ndensity)
 * are final.  It is complete when columns is the width.  None while the last
 * line is not begun.  What it points to stays until team_free(). */
struct team_bottom {
    const struct rad_pixel *pixels; /* painted, if the top is true */
    const uint8_t *density;         /* rad_quincunx_ndensity() of them */
    int columns;
    size_t ndensity;
};
void team_bottom(struct team *t, struct team_bottom *b);

/* Of all members, so far; from any thread.  Rays are told some thousand at a
 * time, waits for the line above [s] when they are over; what a member spins
 * before it goes to sleep is no wait. */
uint64_t team_rays(const struct team *t);
double team_waited(struct team *t);

/* Pixels, traced or not, of the base lines and of the bars that the members
 * have gone over so far, and of the rows that were handed on; for who wants to
 * know how far it is. */
struct team_made {
    uint64_t base, bars, out;
};
struct team_made team_made(const struct team *t);

/* All lines are done, and their rows were handed on. */
bool team_done(const struct team *t);

/* Pixels of the lines whose rows were handed on that the members wanted with
 * TEAM_TRUTH, traced by whomever: the primary rays of the unit (a context's own
 * count has those of all passes).  Without what the view does not show. */
uint64_t team_primary(const struct team *t);

#endif
