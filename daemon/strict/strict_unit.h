/* strict_unit.h - a strict unit of a child, and what it may be in
 *
 * Private to strict*.c.  The machine owns units; a pointer is good until the
 * unit is dropped (strict_order.h).
 * Thread: under the machine's lock, but for cpu_ns, which a team adds to. */
#ifndef DAEMON_STRICT_UNIT_H
#define DAEMON_STRICT_UNIT_H

#include "strict/strict.h"

#include "machine/steps.h"

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

/* The colours of base line first - 1, above the unit, in passes ahead. */
enum strict_above {
    ABOVE_LEFT_OUT,  /* the first bar is not traced ahead */
    ABOVE_MADE_HERE, /* traced here, for no other worker has that line */
    ABOVE_KNOWN      /* the facts of that line came from another worker */
};

/* How long a unit has waited for its top; changed by strict_unit.c. */
struct strict_wait {
    bool waiting;
    bool kept; /* the unit's facts were sent, or are queued, lest the child's
                * death lose them */
    uint64_t since_ms; /* if waiting: from then on */
};

/* Columns of line last - 1 that other workers have; changed by strict_loan.c.
 */
struct strict_lending {
    struct team_blocks lent;
    double part;  /* the part of the line that LEND asks for; 0: no LEND */
    bool blocked; /* TRUTH has done all columns but the lent ones */
};

/* The bottom after LINES or AHEAD; changed by strict_pass.c. */
struct strict_guess {
    struct rad_pixel *pixels; /* NULL: none yet */
    uint8_t *density;
    uint8_t *above; /* the top's densities that the guess was made from; NULL:
                     * from none */
    int known;      /* how many lines above are in it, at most TEAM_SURE */
};

/* Densities that lines [first, last) leave, each line's made from those of the
 * line above, over facts that are here; changed by strict_pass.c. */
struct strict_chain {
    uint8_t *density; /* NULL: none */
    int first, last;
};

/* Columns that another worker lends, and what its pixels point to. */
struct loan {
    struct team_loan is;
    struct rad_pixel *pixels;
    uint8_t *bytes;
};

struct strict_unit {
    struct strict_unit *next;
    struct strict_unit *same_first, *same_last; /* the newer units in the slots
                                                 * of by_first and by_last */
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) */
    enum team_end end;
    uint8_t flags; /* MSG_UNIT_TWIN: facts go out as they are made;
                    * MSG_UNIT_BARS: bars are made along with the lines */
    enum strict_above above;
    enum strict_progress progress; /* by strict_unit_advance() alone */
    enum strict_fate fate;         /* by strict_unit_decide() alone */
    int filled;       /* lines before this one have their bars, as facts */
    bool bottom_done; /* the true bottom was sent */
    bool parked;      /* PARKED was sent, or is queued */
    int out;          /* lines before this one were handed on, by a TRUTH that
                       * ended early */
    int sent_columns; /* of the true bottom */
    size_t sent_densities;
    struct strict_lending lending;
    struct loan *loan; /* the unit is columns that another worker lends; NULL:
                        * the unit is lines */
    struct strict_wait wait;
    struct strict_pass *pass;
    struct msg_counts spent; /* by the unit's passes so far */
    struct team_made made;   /* the most that any pass went over */
    uint64_t *cpu_ns; /* time spent, by line from first - 1 on; a team adds to
                       * it during a pass */
    int nlines;       /* in cpu_ns: lines given away are among them */
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

/* Lines [first, last) of a frame, in no machine yet; NULL: memory is out. */
struct strict_unit *strict_unit_new(uint32_t unit, uint32_t attempt,
                                    uint32_t frame, int first, int last);
void strict_unit_free(struct strict_unit *u);

/* Change the unit's progress or fate; the step must be in strict_progress_steps
 * or strict_fate_steps.  Called by the files of this folder alone. */
void strict_unit_advance(struct strict_unit *u, enum strict_progress to);
void strict_unit_decide(struct strict_unit *u, enum strict_fate to);
/* The first line that the unit makes: its own first, or the base line above. */
int strict_unit_top(const struct strict_unit *u);
/* The unit of that number and attempt that is not gone; NULL: none. */
struct strict_unit *strict_unit_find(const struct strict *s, uint32_t unit,
                                     uint32_t attempt);
/* Keep the most pixels that a pass of the unit has gone over. */
void strict_unit_made(struct strict_unit *u, const struct team_made *made);
/* Is the unit's top here, true and whole?  Line 0 needs none. */
bool strict_unit_has_top(const struct strict *s, const struct strict_unit *u);
/* The unit of this child whose bottom is u's top; whose top is u's bottom.
 * NULL: none. */
struct strict_unit *strict_unit_above(const struct strict *s,
                                      const struct strict_unit *u);
struct strict_unit *strict_unit_below(const struct strict *s,
                                      const struct strict_unit *u);
/* Put a unit into the machine, last of its units; take it out. */
void strict_unit_enter(struct strict *s, struct strict_unit *u);
void strict_unit_leave(struct strict *s, struct strict_unit *u);
/* The unit has lines before `last` alone from now on: what was sent or guessed
 * of its bottom was of another line. */
void strict_unit_end_at(struct strict *s, struct strict_unit *u, int last);

#endif
