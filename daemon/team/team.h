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

#include "picture/facts.h"
#include "picture/quincunx.h"

struct team;
struct rad_ctx; /* a member's own; the callbacks' affair */

enum team_mode { TEAM_TRUTH, TEAM_LINES, TEAM_AHEAD, TEAM_LOAN };

/* So many base lines below one of which nothing is known the densities are as
 * good as true. */
enum { TEAM_SURE = 4 };

/* Where a line is begun, so that workers at the same unit meet late: a line is
 * traced ahead in this order before it is gone over from the left, which other
 * than TEAM_FROM_LEFT wants facts.  Where another worker's facts are met
 * (RAD_FACT_FOREIGN) it goes on in the middle of the widest gap left. */
enum team_end {
    TEAM_FROM_LEFT,
    TEAM_FROM_RIGHT,
    TEAM_MIDDLE_RIGHTWARDS,
    TEAM_MIDDLE_LEFTWARDS
};

/* Trace column x, row y of the picture; false: the view shows nothing there,
 * and *out is what the picture has. */
typedef bool team_trace_fn(void *arg, struct rad_ctx *ctx, int x, int y,
                           struct rad_pixel *out);

/* Paint columns x0 to x1-1 of row y of the picture; row[0] is column x0. */
typedef void team_paint_fn(void *arg, struct rad_ctx *ctx, int x0, int x1,
                           int y, struct rad_pixel *row);

/* Row number `row` of the sampler's area is done; rows of the unit come in
 * order, each once.  The pixels are borrowed for the call, which may wait. */
typedef void team_rows_fn(void *arg, int row, const struct rad_pixel *pixels);

/* The unit's bottom is complete: a member says so, at once and once. */
typedef void team_bottom_fn(void *arg);

/* All rays of a context so far. */
typedef uint64_t team_count_fn(void *arg, const struct rad_ctx *ctx);

/* Blocks of columns of a line, a bit each, from the left. */
struct team_blocks {
    uint64_t base, bar; /* of its base line, of its bar: lent */
    uint64_t ever;      /* not to be lent any more */
};

/* Columns that are lent, all of whole blocks, and what decides which of their
 * pixels count. */
struct team_loan {
    int line, x, n;
    bool base;          /* the base line is to be traced as well */
    double given, left; /* parts of the line's cost: this, and what the lender
                         * has not begun of its own */
    const struct rad_pixel *top;    /* n pixels of the base line above */
    const uint8_t *density;         /* with base: after the line above, all */
    const struct rad_pixel *bottom; /* without: n pixels, as sampled */
    uint8_t *wanted; /* bit i % 8 of byte i / 8: fill column x + i of the bar;
                      * (width + 7) / 8 bytes, of whoever asks */
};

struct team_spec {
    struct rad_quincunx sampler; /* of the window or frame; trace and arg are
                                  * not looked at */
    enum team_mode mode;
    enum team_end end;
    int first, last; /* lines [first, last) of the sampler's */
    /* Colours of base line first - 1, and the densities after it; copied.  With
     * TEAM_TRUTH they are true, and there (but where first is 0, or the sampler
     * has no densities).  Else NULL: no colours; nothing found. */
    const struct rad_pixel *top;
    const uint8_t *top_density;
    bool true_top; /* they are, with LINES or AHEAD */
    int top_known; /* with AHEAD: the densities are a guess that was made of
                    * so many lines; at least TEAM_SURE: that is as good as all
                    */
    /* facts[i] is for line i, as wide as the sampler's area and with as many
     * rows as line i has (team_line_rows()); must stay until team_free().  NULL
     * where there are none; TEAM_TRUTH looks again for each pixel, so they may
     * be stored (release) meanwhile.  LINES and AHEAD want them for all of
     * their lines from the start. */
    _Atomic(struct rad_facts *) *facts;
    int filled; /* with LINES: lines before this one with their bars */
    /* With LINES or AHEAD: room for the densities after each line from first
     * on, or NULL. */
    uint8_t *record;
    /* With LINES, true_top, one member and no bars: what an earlier pass
     * recorded of all lines from first to last - 2, over facts that are here;
     * or NULL.  After a line whose densities come out the same so would all
     * that follow: the pass goes on with the last line. */
    const uint8_t *earlier;
    /* NULL, or room for what each line from first on cost: processor time [ns],
     * added by its member as it leaves the line. */
    uint64_t *cpu_ns;
    /* Of line last - 1, which has columns that are lent. */
    struct team_blocks lent;
    /* With TRUTH: the rows of lines before this one were handed on before.  Of
     * those only base lines are painted again, for what lies below. */
    int out;
    /* With LOAN: first is its line, last the next; top, top_density and the
     * rest about tops are not looked at.  Must stay until team_free(). */
    const struct team_loan *loan;
    team_trace_fn *trace;
    team_paint_fn *paint;   /* NULL: none */
    team_rows_fn *rows;     /* called with TEAM_TRUTH alone */
    team_bottom_fn *bottom; /* NULL: nobody wants to know */
    team_count_fn *count;   /* NULL: the pixels traced are counted */
    void *arg;
    int nthreads; /* members at once, at most */
};

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
