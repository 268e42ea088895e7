/* team_spec.h - what a team is to do, and for whom
 *
 * Lines are those of team.h.  Thread: read-only while members work, but where a
 * field says otherwise. */
#ifndef RADD_DAEMON_TEAM_SPEC_H
#define RADD_DAEMON_TEAM_SPEC_H

#include "picture/facts.h"
#include "picture/quincunx.h"

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

/* Of TEAM_TRUTH alone. */
struct team_truth {
    int out; /* the rows of lines before this one were handed on before; of
              * those only base lines are painted again, for the top below */
    team_rows_fn *rows;
};

/* Of TEAM_LINES and TEAM_AHEAD, whose top may be a guess. */
struct team_ahead {
    bool true_top; /* the top is the true one after all */
    int top_known; /* AHEAD: the densities of the top are a guess that was made
                    * of so many lines; from TEAM_SURE on it is as good as the
                    * truth */
    int filled;    /* LINES: lines before this one with their bars */
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
    /* facts[i] is for line i, as wide as the sampler's area and with as many
     * rows as line i has (team_line_rows()); must stay until team_free().  NULL
     * where there are none; TEAM_TRUTH looks again for each pixel, so they may
     * be stored (release) meanwhile.  LINES and AHEAD want them for all of
     * their lines from the start. */
    _Atomic(struct rad_facts *) *facts;
    /* NULL, or room for what each line from first on cost: processor time [ns],
     * added by its member as it leaves the line. */
    uint64_t *cpu_ns;
    /* Of line last - 1, which has columns that are lent. */
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
