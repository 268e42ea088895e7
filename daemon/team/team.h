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
 *   TEAM_TRUTH  the top is true.  Facts are used, other pixels traced; rows are
 *               painted and handed on; the bottom is true.
 *   TEAM_LINES  the top is a guess.  Base lines are traced, into facts, and of
 *               the first lines the bars as well, as with AHEAD.
 *   TEAM_AHEAD  the top is a guess.  Base lines and bars, into facts.  Left out
 *               are a bar without colours above it (of the first line, if top
 *               is NULL) and, where little is known of the densities above,
 *               pixels that the truth may not trace: all of a bar but columns
 *               between two traced pixels.  (A base line that is sampled with
 *               too little density is a subset of the true one.)
 * LINES and AHEAD hand no rows on and paint nothing; their bottom is a guess,
 * its colours as they were sampled.  To make the base line above the unit as
 * well (MSG_UNIT_TOP), begin LINES and AHEAD one line earlier, with no top: the
 * first line's bar is left out, all others have colours above.
 * Columns of the last line may be lent to another team (team_lend()): a line is
 * traced in blocks of columns, and each block is either claimed by the member
 * or lent.  AHEAD leaves lent blocks out.  TRUTH does all others, then the
 * member leaves (team_blocked()), since rows go out whole; once the columns are
 * back another team goes over the facts.  TEAM_LOAN is the borrower's pass: the
 * columns of one line, into facts.
 * If a unit below waits, it gets the bottom soonest by a pass of LINES under a
 * true top: with true_top the bottom is true, and painted.  TRUTH then goes
 * over the facts.
 *
 * Knows no scene: pixels come from a callback, a pure function of its place.
 * Thread: team_work() from any number of threads at once; team_stop(),
 * team_open(), team_shrink(), team_lend(), team_back(), team_bottom(),
 * team_rays(), team_made() and team_waited() from any; the others while no
 * thread works.  Rows are handed on by one member at a time. */
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

/* No thread works any more: end the unit after the lines whose rows this pass
 * of TRUTH has handed on.  Returns the new `last`; -1: there are no such lines,
 * and nothing changes. */
int team_cut(struct team *t);

/* Columns to a block, but the last. */
int team_block_columns(const struct rad_quincunx *q);

/* The blocks of columns [x, x + n), as bits; 0: these are no whole blocks. */
uint64_t team_blocks_of(const struct rad_quincunx *q, int x, int n);

/* Lend a part (0 to 1) of the blocks of the last line that are not begun, or
 * less; not with LINES.  The team leaves them alone until team_back().  The
 * loan's arrays stay until team_free(); loan->wanted is the caller's.  False:
 * there is no block to lend. */
bool team_lend(struct team *t, double part, struct team_loan *loan);

/* Blocks of the last line that were lent are the team's again. */
void team_back(struct team *t, uint64_t blocks);

/* TRUTH: has a member left because columns are lent?  Rows of lines before
 * *finished were handed on. */
bool team_blocked(const struct team *t, int *finished);

/* The unit's bottom so far: columns [0, columns) and densities [0, ndensity)
 * are final.  It is complete when columns is the width.  None while the last
 * line is not begun.  The arrays stay until team_free(). */
struct team_bottom {
    const struct rad_pixel *pixels; /* painted, if the top is true */
    const uint8_t *density;         /* rad_quincunx_ndensity() elements */
    int columns;
    size_t ndensity;
};
void team_bottom(struct team *t, struct team_bottom *b);

/* Rays of all members so far, up to date within some thousand; time that
 * members slept until the line above was ready [s], counted when they wake. */
uint64_t team_rays(const struct team *t);
double team_waited(struct team *t);

/* Progress: pixels, traced or not, of base lines and of bars that members have
 * gone over so far, and of rows that were handed on. */
struct team_made {
    uint64_t base, bars, out;
};
struct team_made team_made(const struct team *t);

/* All lines are done, and their rows were handed on. */
bool team_done(const struct team *t);

/* Pixels that TEAM_TRUTH wanted in the lines whose rows were handed on, whether
 * traced here or facts: the primary rays of the unit (a context's own count has
 * those of all passes).  Pixels outside of the view do not count. */
uint64_t team_primary(const struct team *t);

#endif
