/* strict_rank.c - which strict unit comes first, and which pass stops for it
 *
 * The most urgent pass is chosen over all units.  A pass ahead that is under
 * way is told to stop when there is a more urgent one. */
#include "config.h"

#include "strict/strict_rank.h"

#include "strict/strict_guess.h"
#include "strict/strict_state.h"

/* Is the unit's bottom not made yet, and may a unit below wait for it? */
static bool
owes_bottom(const struct strict *s, const struct strict_unit *u)
{
    return !u->bottom_done && u->last < frame_of(s, u->frame)->nlines;
}

/* Is it of use to make the bottom before the bars? */
static bool
wants_true_lines(const struct strict *s, const struct strict_unit *u)
{
    if (!owes_bottom(s, u))
        return false;
    /* over facts LINES takes no time, and the bottom comes before the rows; of
     * a single line TRUTH makes the bottom first anyway */
    return u->progress >= PROGRESS_AHEAD || u->last - u->first > 1;
}

/* The rank of the unit's next pass; false: no pass can be made now. */
static bool
next_rank(const struct strict *s, const struct strict_unit *u,
          enum strict_rank *rank)
{
    if (u->pass || is_gone(u) || u->lending.blocked)
        return false;
    if (u->loan)
        *rank = STRICT_LOAN;
    else if (strict_unit_has_top(s, u))
        *rank = wants_true_lines(s, u) ? STRICT_TRUE_LINES : STRICT_TRUTH;
    else if (u->progress < PROGRESS_LINES || guess_is_better(s, u))
        *rank = STRICT_LINES;
    else if (u->progress < PROGRESS_AHEAD)
        *rank = STRICT_AHEAD;
    else
        return false;
    return true;
}

bool
rank_waits(const struct strict *s, const struct strict_unit *u)
{
    enum strict_rank rank;

    return !u->pass && !is_gone(u) && !next_rank(s, u, &rank);
}

bool
strict_waits(const struct strict *s)
{
    for (const struct strict_unit *u = s->units; u; u = u->next)
        if (!u->lending.blocked && rank_waits(s, u))
            return true;
    return false;
}

/* Does unit u come before unit `than'?  Of units for TRUTH those come first
 * whose bottoms other workers may wait for. */
static bool
comes_before(const struct strict *s, enum strict_rank rank,
             const struct strict_unit *u, enum strict_rank than_rank,
             const struct strict_unit *than)
{
    if (rank != than_rank)
        return rank < than_rank;
    if (rank == STRICT_TRUTH && owes_bottom(s, u) != owes_bottom(s, than))
        return owes_bottom(s, u);
    if (u->frame != than->frame)
        return u->frame < than->frame;
    return u->first < than->first;
}

struct strict_unit *
rank_choose(const struct strict *s, enum strict_rank *rank)
{
    struct strict_unit *best = NULL;
    enum strict_rank r;

    for (struct strict_unit *u = s->units; u; u = u->next)
        if (next_rank(s, u, &r) &&
            (!best || comes_before(s, r, u, *rank, best))) {
            best = u;
            *rank = r;
        }
    return best;
}

void
rank_make_way(struct strict *s)
{
    struct strict_pass *last = NULL;

    for (struct strict_unit *u = s->units; u; u = u->next)
        if (u->pass && !u->pass->stop && !strict_has_true_top(u->pass) &&
            (!last || comes_before(s, last->rank, last->of, u->pass->rank, u)))
            last = u->pass;
    if (last)
        last->stop = true;
}

bool
strict_has_work(const struct strict *s)
{
    enum strict_rank rank;

    return !s->error && rank_choose(s, &rank);
}
