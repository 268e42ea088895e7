/* strict_unit.h - a strict unit of a child, and what it may be in
 *
 * Private to strict*.c; the functions are in strict_impl.h. */
#ifndef DAEMON_STRICT_UNIT_H
#define DAEMON_STRICT_UNIT_H

#include "strict/strict.h"

#include "machine/steps.h"

struct loan;

/* What is traced of a unit before its true top is there.  Lower case: the pass
 * that ended, or what came:
 *
 *   NONE --lines--> LINES --ahead--> AHEAD --colours above came--> LINES
 *                     '--ahead, the colours above being here--> GUESSED
 *
 * The unit has after LINES its base lines, after AHEAD its bars but the first,
 * which needs the colours of the base line above, after GUESSED all bars. */
enum strict_progress {
    PROGRESS_NONE,
    PROGRESS_LINES,
    PROGRESS_AHEAD,
    PROGRESS_GUESSED
};
#define STRICT_PROGRESSES 4
extern const struct steps strict_progress_steps;

/* What becomes of a unit when its pass has ended (at once, if it has none):
 *
 *   STAYS <--> SPLITS
 *   STAYS, SPLITS         --> YIELDS
 *   STAYS, SPLITS, YIELDS --> OVER or GONE */
enum strict_fate {
    FATE_STAYS,
    FATE_SPLITS, /* half of its lines go back (SPLIT) */
    FATE_YIELDS, /* it goes back (YIELD) */
    FATE_OVER,   /* what it cost is told: all its rows are made, or PAID */
    FATE_GONE    /* it is freed, for nobody wants it (REVOKE) */
};
#define STRICT_FATES 5
extern const struct steps strict_fate_steps;

/* The base line above a unit, number first - 1, when it is gone over ahead. */
enum strict_above {
    ABOVE_LEFT_OUT,
    ABOVE_MADE_HERE, /* since nobody else makes it */
    ABOVE_KNOWN      /* with the facts of whoever has it, which are all that a
                      * guess wants */
};

/* How long a unit has waited for its top; changed by strict_unit.c. */
struct strict_wait {
    bool waiting;
    bool kept; /* its facts are out, or about to be, in case its child dies */
    uint64_t since_ms; /* waiting: from when */
};

/* Columns of line last - 1 that other workers have; changed by strict_loan.c.
 */
struct strict_lending {
    struct team_blocks lent;
    double part;  /* a part of the line is asked for; 0: none is */
    bool blocked; /* TRUTH has done all but these */
};

/* The bottom after LINES or AHEAD; changed by strict_pass.c. */
struct strict_guess {
    struct rad_pixel *pixels; /* NULL: none yet */
    uint8_t *density;
    uint8_t *above; /* the densities that it follows from; NULL: it was made of
                     * nothing */
    int known;      /* lines that it is made of, at most TEAM_SURE */
};

/* Densities after lines [first, last), each made from those of the line above,
 * all over facts that are here; changed by strict_pass.c. */
struct strict_chain {
    uint8_t *density; /* NULL: none */
    int first, last;
};

struct strict_unit {
    struct strict_unit *next;
    struct strict_unit *same_first, *same_last; /* in their slots; the newer */
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) */
    enum team_end end;
    uint8_t flags; /* MSG_UNIT_TWIN: facts go out as they are made;
                    * MSG_UNIT_BARS: bars are made along with the lines */
    enum strict_above above;
    enum strict_progress progress; /* by strict_unit_advance() alone */
    enum strict_fate fate;         /* by strict_unit_decide() alone */
    int filled;       /* lines before this one have their bars, as facts */
    bool bottom_done; /* the bottom is out, true */
    bool parked;      /* said, or about to be */
    int out;          /* lines before it were handed on, by TRUTH that ended
                       * early */
    int sent_columns; /* of the bottom, true */
    size_t sent_densities;
    struct strict_lending lending;
    struct loan *loan; /* what another worker lends, which is all that there is
                        * of this unit; NULL: it is one */
    struct strict_wait wait;
    struct strict_pass *pass;
    struct msg_counts spent; /* by its passes so far */
    struct team_made made;   /* the most that one of them went over */
    uint64_t *cpu_ns; /* of that, by line, its top's first; a team adds to
                       * it during a pass */
    int nlines;       /* so many; it may have given some away */
    struct strict_guess guess;
    struct strict_chain chain;
};

static inline bool
is_gone(const struct strict_unit *u)
{
    return u->fate == FATE_GONE;
}

/* Is that line the unit's own, or the one whose base line is its top? */
static inline bool
covers(const struct strict_unit *u, uint32_t frame, int line)
{
    return u->frame == frame && line < u->last && line >= u->first - 1;
}

#endif
