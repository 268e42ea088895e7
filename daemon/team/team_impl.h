/* team_impl.h - shared by the files of a team, and private to them
 *
 *   team.c         set-up and end, the next line, calls from outside
 *   team_line.c    a member's work: a base line, then the bar above it
 *   team_member.c  how a member traces, waits, and wakes the line below
 *   team_blocks.c  the rows of a line, and its blocks of columns
 *   team_sweep.c   a line traced ahead, block by block
 *   team_help.c    blocks of lines that other members are at
 *   team_lend.c    columns that are lent to another team
 *
 * A line needs from the line above
 *   - the densities up to a little ahead of its own place (`ready');
 *   - for its bar, the pixels as they are in the picture (painted).
 * The bar's lower edge is the base line as it was sampled, before painting, as
 * in rpict; so a line keeps both.
 *
 * Only the member of the line below waits for a line.  It is woken when the
 * densities that it waits for are there, not at each step.  Before it sleeps it
 * traces pixels of its own line that are wanted whatever the densities are: the
 * line below finds ambient records that the line above made, so its member is
 * faster and would wait most of the time.  Lines are begun in order, and the
 * topmost line that is not done waits for no other, so no member waits for
 * ever.  Buffers form a ring: line i is begun only when line i - nlines + 1,
 * the last that uses the same buffers or reads them, is done and its rows are
 * handed on.  The top is in the buffer of line first - 1. */
#ifndef DAEMON_TEAM_IMPL_H
#define DAEMON_TEAM_IMPL_H

#include "team/team.h"

#include <stdatomic.h>
#include <uv.h>

/* Most blocks of a line: bits of a uint64_t. */
#define MOST_BLOCKS 64

/* Blocks are counted apart for a base line and for its bar. */
enum line_part { LINE_BASE, LINE_BAR, LINE_PARTS };

struct line {
    uint8_t *density;          /* after this line; written by its member */
    struct rad_pixel *sampled; /* its base line; written by its member */
    /* Pixels of the base line that its member traced before it slept, where
     * known[] is set; only the member uses them.  NULL: no member ever waits.
     */
    struct rad_pixel *early;
    bool *known;
    /* How many densities are final; stored after them, pairs with the load in
     * wait_for().  Their number + 1: the base line is painted, too. */
    _Atomic size_t ready;
    /* For how many the member of the line below sleeps; 0: it does not. */
    _Atomic size_t wanted;
    uv_cond_t moved;   /* ready has reached wanted, or the team is stopped */
    _Atomic int shown; /* columns that are painted into their row */
    /* Blocks that the line's member began, or that are lent: the thread that
     * sets a bit has the block.  No other data depends on the bits;
     * sequentially consistent, as a weaker order would gain nothing. */
    _Atomic uint64_t taken[LINE_PARTS];
    /* [mu] Blocks that helpers took, and of these the ones that they did; with
     * those of which the member traced pixels early. */
    uint64_t helped[LINE_PARTS], helped_done[LINE_PARTS];
    /* What helpers traced while spec.facts had no facts of the line; made by
     * the first of them, with mu held, and stays until the line's buffers get
     * another line.  Stored (release) for recall(). */
    _Atomic(struct rad_facts *) own;
    uint64_t primary; /* [mu] valid with done; see team_primary() */
    bool done;        /* [mu] base line and bar are done */
};

struct team {
    struct team_spec spec;    /* [fixed] but for last, see below */
    size_t ndensity;          /* [fixed] densities after a line */
    int nlines, nslots;       /* [fixed] lengths of lines, and of slots in rows
                               */
    uint8_t *density;         /* [fixed] of the top, then of the lines */
    bool *known;              /* [fixed] of all lines; NULL: one thread */
    struct rad_pixel *pixels; /* [fixed] of the lines, then slots */
    struct rad_pixel *slots;  /* [fixed] row k is in slot k modulo nslots */
    struct line *lines;       /* [fixed] line i is in place i % nlines */
    uv_mutex_t mu;
    uv_cond_t moved;       /* finished, last, stopped or a line's helped_done
                            * has changed */
    _Atomic int last;      /* end of the lines; written with mu held, relaxed
                            * without */
    int begun;             /* [mu] the next line to begin */
    int finished;          /* [mu] rows of all lines before it are handed on */
    bool handing_on;       /* [mu] a member hands rows on */
    bool helpless;         /* [mu] there was no memory for a helper's facts */
    double waited_s;       /* [mu] in wait_for() */
    _Atomic uint64_t rays; /* relaxed: shown, never decided on */
    _Atomic uint64_t base, bars, out; /* relaxed, likewise; of team_made() */
    uint64_t primary;                 /* [mu] of lines before finished */
    _Atomic bool stopped;    /* relaxed where it only ends work earlier */
    struct team_blocks lent; /* [mu] of line spec.last - 1 */
    bool blocked; /* [mu] a member has left because columns are lent */
};

static inline struct line *
line_at(const struct team *t, int i)
{
    return &t->lines[i % t->nlines];
}

static inline struct rad_pixel *
row_at(const struct team *t, int row)
{
    return t->slots + (size_t)(row % t->nslots) * (size_t)t->spec.sampler.width;
}

static inline bool
is_stopped(const struct team *t)
{
    return atomic_load_explicit(&t->stopped, memory_order_relaxed);
}

/* Count rows, of the sampler's width, in a number of team_made(). */
static inline void
team_add(struct team *t, _Atomic uint64_t *made, int rows)
{
    atomic_fetch_add_explicit(made,
                              (uint64_t)rows * (uint64_t)t->spec.sampler.width,
                              memory_order_relaxed);
}

static inline bool
is_wanted(const struct team_loan *loan, int x)
{
    int i = x - loan->x;

    return loan->wanted[i / 8] >> i % 8 & 1;
}

/* The facts of line i; NULL: it has none. */
static inline struct rad_facts *
team_facts(const struct team *t, int i)
{
    return t->spec.facts
               ? atomic_load_explicit(&t->spec.facts[i], memory_order_acquire)
               : NULL;
}

/* Does this pass fill the bar of line i? */
static inline bool
has_bar(const struct team *t, int i)
{
    return i > 0 && t->spec.mode != TEAM_LINES &&
           (i > t->spec.first || t->spec.top || t->spec.loan);
}

/* --- team.c --- */

/* Begin the next line, once its buffers are free; -1: there is none. */
int team_line_begin(struct team *t);
/* Line i is done, and wanted `primary` pixels: hand on all rows that are
 * complete now. */
void team_line_finish(struct team *t, struct rad_ctx *ctx, int i,
                      uint64_t primary);

#endif
