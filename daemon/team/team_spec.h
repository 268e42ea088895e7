/* team_spec.h - the work of a team: lines, mode, callbacks
 *
 * Lines are those of team.h.  Thread: read-only while members work, but where a
 * field says otherwise. */
#ifndef RADD_DAEMON_TEAM_SPEC_H
#define RADD_DAEMON_TEAM_SPEC_H

#include "picture/facts.h"
#include "picture/quincunx.h"

struct rad_ctx; /* a member's own; the callbacks' affair */

enum team_mode { TEAM_TRUTH, TEAM_LINES, TEAM_AHEAD, TEAM_LOAN };

/* So many base lines below a line of which nothing is known, guessed densities
 * are as good as true. */
enum { TEAM_SURE = 4 };

/* Where a line is begun, so that workers at the same unit meet late.  A line is
 * traced ahead in this order, into facts, and then gone over from the left;
 * TEAM_FROM_LEFT needs no facts.  Where a member meets another worker's facts
 * (RAD_FACT_FOREIGN) it goes on in the middle of the widest gap left. */
enum team_end {
    TEAM_FROM_LEFT,
    TEAM_FROM_RIGHT,
    TEAM_MIDDLE_RIGHTWARDS,
    TEAM_MIDDLE_LEFTWARDS
};

/* Trace column x, row y of the picture; false: the view shows nothing there,
 * and *out is the picture's value for that. */
typedef bool team_trace_fn(void *arg, struct rad_ctx *ctx, int x, int y,
                           struct rad_pixel *out);

/* Paint columns x0 to x1-1 of row y of the picture; row[0] is column x0. */
typedef void team_paint_fn(void *arg, struct rad_ctx *ctx, int x0, int x1,
                           int y, struct rad_pixel *row);

/* Row number `row` of the sampler's area is done; rows of the unit come in
 * order, each once.  The pixels are borrowed for the call, which may wait. */
typedef void team_rows_fn(void *arg, int row, const struct rad_pixel *pixels);

/* All rows of a line are done, those of its bar and its own, n from `first` on
 * of the sampler's area: asked of a member before they are handed on. */
typedef void team_look_fn(void *arg, struct rad_ctx *ctx, int first, int n,
                          const struct rad_pixel *const row[]);

/* The unit's bottom is complete: a member says so, at once and once. */
typedef void team_bottom_fn(void *arg);

/* All rays of a context so far. */
typedef uint64_t team_count_fn(void *arg, const struct rad_ctx *ctx);

/* Blocks of columns of a line, a bit each, from the left. */
struct team_blocks {
    uint64_t base, bar; /* of its base line, of its bar: lent */
    uint64_t ever;      /* not to be lent any more */
};

/* Columns that are lent, whole blocks, and the data that decide which of their
 * pixels are traced. */
struct team_loan {
    int line, x, n;
    bool base;          /* the base line is to be traced as well */
    double given, left; /* parts of the line's cost: the loan's; and that of
                         * blocks that the lender keeps and has not begun */
    const struct rad_pixel *top;    /* n pixels of the base line above */
    const uint8_t *density;         /* with base: after the line above, all */
    const struct rad_pixel *bottom; /* without: n pixels, as sampled */
    uint8_t *wanted; /* bit i % 8 of byte i / 8: fill column x + i of the bar;
                      * (width + 7) / 8 bytes, the caller's */
};

/* Of TEAM_TRUTH alone. */
struct team_truth {
    int out; /* rows of lines before this one were handed on by an earlier
              * pass; their base lines alone are painted again, as tops */
    team_rows_fn *rows;
    team_look_fn *look; /* NULL: nobody wants to see them */
};

/* Of TEAM_LINES and TEAM_AHEAD, whose top may be a guess. */
struct team_ahead {
    bool true_top; /* LINES: the top is true */
    int top_known; /* AHEAD: the densities of the top were guessed from so many
                    * lines; from TEAM_SURE on they are as good as true */
    int filled;    /* LINES: make the bars of lines before this one, too */
    /* Room for the densities after each line from `first` on; or NULL. */
    uint8_t *record;
    /* LINES with true_top, one member and no bars: what an earlier pass recorded
     * of all lines from `first` to last - 2, over facts that are here; or NULL.
     * If a line's densities come out the same, so would those of all lines that
     * follow it: the pass goes on with the last line. */
    const uint8_t *earlier;
};

struct team_spec {
    struct rad_quincunx sampler; /* of the window or frame; trace and arg are
                                  * not looked at */
    enum team_mode mode;
    enum team_end end;
    int first, last; /* lines [first, last) of the sampler's */
    /* Colours of base line first - 1, and the densities that it leaves; copied.
     * With TEAM_TRUTH they are true and not NULL (but if first is 0, or the
     * sampler has no densities).  Else NULL: no colours; no density known. */
    const struct rad_pixel *top;
    const uint8_t *top_density;
    /* facts[i] is for line i, as wide as the sampler's area and with as many
     * rows as line i has (team_line_rows()); must stay until team_free(); NULL:
     * the line has no facts.  TEAM_TRUTH looks again for each pixel, so facts
     * may be stored (release) meanwhile.  LINES and AHEAD need facts for all
     * lines from the start. */
    _Atomic(struct rad_facts *) *facts;
    /* NULL, or the processor time of each line from first on [ns], to which the
     * line's member adds as it leaves the line. */
    uint64_t *cpu_ns;
    /* Blocks of line last - 1 that are lent. */
    struct team_blocks lent;
    /* With LOAN: first is its line, last the next; top, top_density and the
     * rest about tops are not looked at.  Must stay until team_free(). */
    const struct team_loan *loan;
    struct team_truth truth;
    struct team_ahead ahead;
    team_trace_fn *trace;
    team_paint_fn *paint;   /* NULL: none */
    team_bottom_fn *bottom; /* NULL: nobody wants to know */
    team_count_fn *count;   /* NULL: the pixels traced are counted */
    void *arg;
    int nthreads; /* members at once, at most */
};

#endif
