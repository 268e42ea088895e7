/* team_spec.h - what a team is to do: lines, mode, callbacks
 *
 * Lines are those of team.h.
 * Thread: read-only while members work, unless a field says otherwise. */
#ifndef RADD_DAEMON_TEAM_SPEC_H
#define RADD_DAEMON_TEAM_SPEC_H

#include "picture/facts.h"
#include "picture/quincunx.h"

struct rad_ctx; /* each member has its own, for the callbacks */

enum team_mode { TEAM_TRUTH, TEAM_LINES, TEAM_AHEAD, TEAM_LOAN };

/* Where nothing is known of a line, guessed densities are as good as true ones
 * this many base lines below it. */
enum { TEAM_SURE = 4 };

/* Trace column x, row y of the picture into *out; false: the view shows nothing
 * there, and *out is the picture's value for that. */
typedef bool team_trace_fn(void *arg, struct rad_ctx *ctx, int x, int y,
                           struct rad_pixel *out);

/* Paint small sources on columns x0 to x1 - 1 of row y of the picture; row[0]
 * is column x0. */
typedef void team_paint_fn(void *arg, struct rad_ctx *ctx, int x0, int x1,
                           int y, struct rad_pixel *row);

/* Take row number `row` of the sampler's area, which is done; rows of the unit
 * come in order, each once.  The pixels are borrowed for the call, which may
 * wait. */
typedef void team_rows_fn(void *arg, int row, const struct rad_pixel *pixels);

/* Look at the n rows of a line, from `first` of the sampler's area on, before
 * they are handed on. */
typedef void team_look_fn(void *arg, struct rad_ctx *ctx, int first, int n,
                          const struct rad_pixel *const row[]);

/* The unit's bottom is complete; called once, at once, by a member. */
typedef void team_bottom_fn(void *arg);

/* A base line is complete, so there may be blocks for threads that have nothing
 * to do (team_open()). */
typedef void team_help_fn(void *arg);

/* The number of rays that were traced with a context so far. */
typedef uint64_t team_count_fn(void *arg, const struct rad_ctx *ctx);

/* Blocks of columns of a line, one bit each, from the left. */
struct team_blocks {
    uint64_t base, bar; /* of its base line, and of its bar, that are lent */
    uint64_t ever;      /* that were lent once, and may not be again */
};

/* Columns that are lent, in whole blocks, with what decides which of their
 * pixels are traced. */
struct team_loan {
    int line, x, n;     /* columns [x, x + n) of that line */
    bool base;          /* the base line is to be traced, too */
    double given, left; /* parts of the line's cost: the loan's; and that of
                         * blocks that the lender keeps and has not begun */
    const struct rad_pixel *top;    /* n pixels of the base line above */
    const uint8_t *density;         /* with base: all densities after the line
                                     * above; else NULL */
    const struct rad_pixel *bottom; /* without base: n pixels of the base line,
                                     * as sampled; else NULL */
    uint8_t *wanted; /* bit i % 8 of byte i / 8: fill column x + i of the bar;
                      * (width + 7) / 8 bytes of the caller's */
};

/* For TEAM_TRUTH only. */
struct team_truth {
    int out; /* an earlier pass handed on the rows of lines before this one; of
              * these only the base lines are painted again, as tops */
    team_rows_fn *rows;
    team_look_fn *look; /* or NULL */
};

/* For TEAM_LINES and TEAM_AHEAD. */
struct team_ahead {
    bool true_top; /* LINES: the top is true */
    int top_known; /* AHEAD: how many lines the guessed densities of the top
                    * follow from; TEAM_SURE lines make them as good as true */
    /* Room for the densities after each line from `first` on; or NULL. */
    uint8_t *record;
};

struct team_spec {
    struct rad_quincunx sampler; /* of the window or frame; its trace and arg
                                  * are not used */
    enum team_mode mode;
    int first, last; /* lines [first, last) of the sampler's area */
    /* Colours of base line first - 1, and the densities after it; copied.  For
     * TEAM_TRUTH they are true and not NULL, unless first is 0 or the sampler
     * has no densities.  For other modes NULL means: not known. */
    const struct rad_pixel *top;
    const uint8_t *top_density;
    /* facts[i] is of line i: as wide as the sampler's area, with as many rows
     * as line i has (team_line_rows()); stays until team_free().  NULL: the
     * line has no facts.  TEAM_TRUTH looks for each pixel, so facts may be
     * stored (release) meanwhile.  LINES and AHEAD need facts of all lines from
     * the start. */
    _Atomic(struct rad_facts *) *facts;
    /* NULL, or processor time of each line from `first` on [ns], to which a
     * member adds when it leaves the line. */
    uint64_t *cpu_ns;
    /* Blocks of line last - 1 that are lent. */
    struct team_blocks lent;
    /* Of TEAM_LOAN, for which last is first + 1 and the tops are not used;
     * stays until team_free(). */
    const struct team_loan *loan;
    struct team_truth truth;
    struct team_ahead ahead;
    team_trace_fn *trace;
    team_paint_fn *paint;   /* NULL: nothing is painted */
    team_bottom_fn *bottom; /* or NULL */
    team_help_fn *help;     /* or NULL */
    team_count_fn *count;   /* NULL: traced pixels are counted as rays */
    void *arg;              /* of all callbacks */
    int nthreads;           /* most members at once */
};

#endif
