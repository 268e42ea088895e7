/* team_impl.h - what the files of a team share
 *
 * Private to team*.c:
 *   team.c         set-up and end, which line is next, what is asked of a team
 *   team_line.c    what a member does: a base line, then the bar above it
 *   team_member.c  how a member traces, waits and tells
 *   team_blocks.c  the rows of a line, and its blocks of columns
 *   team_sweep.c   a line traced ahead by blocks
 *   team_lend.c    columns that are lent to another team
 *
 * What a line needs from the one above:
 *   - its densities, up to a little ahead of where it is itself (`ready`);
 *   - at last, its pixels as they are in the picture, small sources painted,
 *     as the top of the bar.
 * The bar's bottom is the line as it was sampled, before painting, as in
 * rpict; so a line keeps both.
 *
 * Nobody but the member of the line below waits for a line, and it is woken
 * when there is what it waits for, not at each step.  Before it goes to sleep
 * it traces what its own line will want whatever the densities are: where the
 * line above makes ambient records that the one below finds there, the one
 * below is faster and would wait most of the time.  Lines are begun in order,
 * and the lowest one that is not done waits for nobody; so nobody waits for
 * ever.  Buffers form a ring: line i is begun only when line i - nlines + 1,
 * the last to look at its buffers, is done and its rows are handed on.  The top
 * lies where the ring has line first - 1. */
#ifndef DAEMON_TEAM_IMPL_H
#define DAEMON_TEAM_IMPL_H

#include "team/team.h"

#include <stdatomic.h>
#include <uv.h>

/* Blocks of a line at most: bits of a number. */
#define MOST_BLOCKS 64

/* The two things that blocks of a line are of. */
enum part { PART_BASE, PART_BAR, NPART };

struct line {
    uint8_t *density;          /* for the line below; written by its member */
    struct rad_pixel *sampled; /* written by its member */
    /* Pixels of the base line that its member traced while it waited, where
     * known says so; they are its own.  NULL: nobody waits. */
    struct rad_pixel *early;
    bool *known;
    /* Densities that are final, stored after them; pairs with the load in
     * wait_for().  One more than all of them: the line is painted. */
    _Atomic size_t ready;
    /* So many does the member of the line below wait for, asleep; 0: none. */
    _Atomic size_t wanted;
    uv_cond_t moved;   /* with ready, as far as wanted, and stopped */
    _Atomic int shown; /* columns that are in their row, painted */
    /* Blocks that its member began, or that are lent: whoever sets a bit has
     * the block.  Nothing else is told by it: sequentially consistent for want
     * of a reason. */
    _Atomic uint64_t taken[NPART];
    uint64_t primary; /* [mu] with done: see team_primary() */
    bool done;        /* [mu] and the bar above it */
};

struct team {
    struct team_spec spec;    /* [fixed] but for last; see there */
    size_t ndensity;          /* [fixed] */
    int nlines, nslots;       /* [fixed] */
    uint8_t *density;         /* [fixed] the top's, then the lines' */
    bool *known;              /* [fixed] the lines'; NULL: one thread */
    struct rad_pixel *pixels; /* [fixed] the lines' and the slots' */
    struct rad_pixel *slots;  /* [fixed] row k in slot k modulo nslots */
    struct line *lines;       /* [fixed] line i is number i % nlines */
    uv_mutex_t mu;
    uv_cond_t moved;       /* with finished, last and stopped */
    _Atomic int last;      /* written with mu held; relaxed without */
    int begun;             /* [mu] lines */
    int finished;          /* [mu] lines whose rows, and all above, are out */
    bool handing_on;       /* [mu] a member hands rows on */
    double waited_s;       /* [mu] in wait_for() */
    _Atomic uint64_t rays; /* relaxed: shown, never decided on */
    _Atomic uint64_t base, bars, out; /* relaxed: likewise; team_made() */
    uint64_t primary;                 /* [mu] of the lines that are finished */
    _Atomic bool stopped;    /* relaxed where it only ends work earlier */
    struct team_blocks lent; /* [mu] of line spec.last - 1 */
    bool blocked; /* [mu] a member has left because of what is lent */
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

/* Count rows of the sampler's width for team_made(). */
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

/* Has line i's bar to be filled in this pass? */
static inline bool
has_bar(const struct team *t, int i)
{
    return i > 0 && (t->spec.mode != TEAM_LINES || i < t->spec.ahead.filled) &&
           (i > t->spec.first || t->spec.top || t->spec.loan);
}

/* --- team.c --- */

/* The next line to begin, once its buffers are free; -1: there is none. */
int team_line_begin(struct team *t);
/* It is done, and wanted so many pixels: hand on what thereby is complete. */
void team_line_finish(struct team *t, int i, uint64_t primary);

#endif
