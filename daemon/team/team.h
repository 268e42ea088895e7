/* team.h - the threads that go over one unit together
 *
 * The unit is a run of lines of a sampler's area: a whole window, or some lines
 * of a frame that is sampled as one (a strict unit).  Line i stands for base
 * line i and the bar above it.  The team makes the pixels, and traces the rays,
 * that a single thread would.  Each member takes a line.  It samples the base
 * line close behind the member on the line above, whose densities it needs,
 * then fills the bar.  So the members move across the area in echelon, and what
 * one line waits for in the line above is a number in memory.  A member that
 * finds no line to begin helps with blocks of the others' (team_help.c).
 *
 * A unit needs its top: the base line above its first line, as it is in the
 * picture (small sources painted), and the densities after it.  A unit that
 * begins with line 0 needs none.  Its bottom is its last base line: the top of
 * the unit below.  A team makes one pass over the unit.  A unit whose top comes
 * late gets several passes, each by a new team over the same facts (facts.h):
 *   TEAM_TRUTH  the top is true.  Facts are used, other pixels traced; rows are
 *               painted and handed on; the bottom is true.
 *   TEAM_LINES  the top is a guess.  Base lines are traced, into facts.
 *   TEAM_AHEAD  the top is a guess.  Base lines and bars become facts, but
 *               not the first line's bar if there is no top above it.  Where
 *               little is known of the densities above, pixels of a bar that
 *               TRUTH might not trace are left out: those of all columns that
 *               do not lie between two traced pixels.  (A base line that is
 *               sampled with too little density is a subset of the true one.)
 * LINES and AHEAD hand no rows on and paint nothing; their bottom is a guess,
 * in the colours that were sampled.  To go over the base line above the unit as
 * well they begin one line earlier, without the colours of a top: the first
 * line's bar is left out, all other bars have colours above.
 * Columns of the last line may be lent to another team (team_lend()): a line is
 * traced in blocks of columns, and each block is either claimed by the member
 * or lent.  AHEAD leaves lent blocks out.  In TRUTH the member does all other
 * blocks and then leaves (team_blocked()), for rows are handed on whole; when
 * the columns are back another team goes over the facts.  TEAM_LOAN is the
 * borrower's pass: columns of one line, into facts.
 * A pass of LINES under a true top (true_top) makes the bottom soonest, for a
 * unit below that waits: then the bottom is true, and painted.  TRUTH goes over
 * the facts later.
 *
 * A team knows no scene: pixels come from a callback, a pure function of the
 * pixel's place.
 * Thread: team_work() from several threads at once; team_stop(), team_open(),
 * team_helps(), team_shrink(), team_lend(), team_back(), team_bottom(),
 * team_rays(), team_made() and team_waited() from any; all others while no
 * thread works.  Rows are handed on by one member at a time. */
#ifndef RADD_DAEMON_TEAM_H
#define RADD_DAEMON_TEAM_H

#include "team/team_spec.h"

struct team;

/* Make a team; *spec is copied.  NULL: memory is out. */
struct team *team_new(const struct team_spec *spec);
void team_free(struct team *t);

/* The rows of line i of a sampler's area: the first row, and their number. */
int team_line_row(const struct rad_quincunx *q, int i);
int team_line_rows(const struct rad_quincunx *q, int i);

/* Work as a member until there is no line to begin and no block to help with
 * just now, or the team is stopped. */
void team_work(struct team *t, struct rad_ctx *ctx);

/* Is there a line for another member to begin? */
bool team_open(struct team *t);

/* Is there no line, but a block of one for another member to help with? */
bool team_helps(struct team *t);

/* End early: each member leaves within a few pixels. */
void team_stop(struct team *t);

/* Give away half (rounded up) of the lines that are not begun, from the end,
 * but none before line `least`.  Returns the new end of the lines, as
 * spec.last. */
int team_shrink(struct team *t, int least);

/* End the unit after the lines whose rows this pass of TRUTH has handed on; no
 * thread works any more.  Returns the new end of the lines; -1: no rows were
 * handed on, and nothing changes. */
int team_cut(struct team *t);

/* Columns of a block; the last may have fewer. */
int team_block_columns(const struct rad_quincunx *q);

/* The blocks of columns [x, x + n), as bits; 0: these columns are no whole
 * blocks.
 */
uint64_t team_blocks_of(const struct rad_quincunx *q, int x, int n);

/* Lend at most a part (0 to 1) of the cost of those blocks of the last line
 * that are not begun; not in LINES.  The team leaves these blocks alone until
 * team_back().  The arrays of *loan stay until team_free(), but for
 * loan->wanted, which is the caller's.  False: there is no block to lend. */
bool team_lend(struct team *t, double part, struct team_loan *loan);

/* Lent blocks of the last line are the team's again. */
void team_back(struct team *t, uint64_t blocks);

/* Did a member of TRUTH leave because columns are lent?  *finished: the rows of
 * all lines before it were handed on. */
bool team_blocked(const struct team *t, int *finished);

/* The unit's bottom so far: columns [0, columns) and densities [0, ndensity)
 * are final.  It is complete when columns is the width.  All zeros while the
 * last line is not begun.  The arrays stay until team_free(). */
struct team_bottom {
    const struct rad_pixel *pixels; /* painted, if the top is true */
    const uint8_t *density;         /* rad_quincunx_ndensity() elements */
    int columns;
    size_t ndensity;
};
void team_bottom(struct team *t, struct team_bottom *b);

/* Rays of all members so far, up to some thousand that are not counted yet.
 * Time that members slept until the line above was ready [s], counted when they
 * wake up. */
uint64_t team_rays(const struct team *t);
double team_waited(struct team *t);

/* How many pixels, traced or not, members have gone over so far: of base lines,
 * of bars, and of rows that were handed on. */
struct team_made {
    uint64_t base, bars, out;
};
struct team_made team_made(const struct team *t);

/* Are all lines done, and their rows handed on? */
bool team_done(const struct team *t);

/* The unit's primary rays: pixels that TRUTH wanted in lines whose rows were
 * handed on, whether it traced them or had them as facts; other modes have
 * none. (A context's count has the traced pixels of all passes.)  Pixels
 * outside of the view do not count. */
uint64_t team_primary(const struct team *t);

#endif
