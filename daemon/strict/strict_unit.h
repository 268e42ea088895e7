/* strict_unit.h - a strict unit of a child, and its states; private to
 * strict*.c
 *
 * The machine owns units; a pointer is valid until the unit is dropped
 * (strict_order.h).
 * Thread: under the machine's lock, but for cpu_ns, which a team adds to. */
#ifndef DAEMON_STRICT_UNIT_H
#define DAEMON_STRICT_UNIT_H

#include "strict/strict.h"

#include "machine/steps.h"

/* What is traced of a unit before its true top is there.  The arrows name the
 * pass that ended:
 *
 *   NONE --lines--> LINES --ahead--> AHEAD
 *                     '<--------------' lines, with a better guess at the
 *                                       densities above; or colours above came
 *
 * LINES: the base lines; AHEAD: also the bars, the first only if the colours of
 * the base line above were known or guessed when the pass began. */
enum strict_progress { PROGRESS_NONE, PROGRESS_LINES, PROGRESS_AHEAD };
#define STRICT_PROGRESSES 3
extern const struct steps strict_progress_steps;

/* What becomes of a unit when its pass has ended; at once if it has none:
 *
 *   STAYS <--> SPLITS
 *   STAYS, SPLITS         --> YIELDS
 *   STAYS, SPLITS, YIELDS --> OVER or GONE */
enum strict_fate {
    FATE_STAYS,
    FATE_SPLITS, /* it gives half of its lines away (SPLIT) */
    FATE_YIELDS, /* it is given back (YIELD) */
    FATE_OVER,   /* it is finished, or PAID: its cost is told */
    FATE_GONE    /* it is dropped (REVOKE) */
};
#define STRICT_FATES 5
extern const struct steps strict_fate_steps;

/* Where passes ahead get the colours of base line first - 1, above the unit. */
enum strict_above {
    ABOVE_LEFT_OUT,  /* nowhere: the first bar is not traced ahead */
    ABOVE_MADE_HERE, /* they trace it, for no other worker has that line */
    ABOVE_KNOWN      /* from facts of that line, which another worker sent */
};

/* Of a unit that waits for its top; changed by strict_order.c. */
struct strict_wait {
    bool waiting;
    bool kept;         /* since the last pass the unit's facts were sent or
                        * queued, in case this worker is lost */
    uint64_t since_ms; /* when it began to wait; with waiting */
};

/* Columns of line last - 1 that other workers have; changed by strict_loan.c.
 */
struct strict_lending {
    struct team_blocks lent;
    double part;  /* part of the line that LEND asks for; 0: no LEND is open */
    bool blocked; /* TRUTH has done all columns but the lent ones */
};

/* The bottom that LINES or AHEAD left; changed by strict_guess.c. */
struct strict_guess {
    struct rad_pixel *pixels; /* NULL: none yet */
    uint8_t *density;
    uint8_t *above; /* densities of the top that it was made from; NULL: not
                     * known */
    int known;      /* how many lines above it follows from */
    int told;       /* the same of the densities above the last line, when the
                     * unit below was last sent them; 0: it was not */
};

/* The densities after lines [first, last), each line's made from those of the
 * line above, over facts that are here; changed by strict_guess.c. */
struct strict_chain {
    uint8_t *density; /* NULL: none */
    int first, last;
    int known; /* how many lines those above `first' follow from */
};

/* Columns that another worker lends to this child. */
struct loan {
    struct team_loan is; /* its pointers lead into pixels and bytes */
    struct rad_pixel *pixels;
    uint8_t *bytes;
};

struct strict_unit {
    struct strict_unit *next;
    struct strict_unit *same_first, *same_last; /* next in the slots of
                                                 * by_first and by_last */
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) */
    enum strict_above above;
    enum strict_progress progress; /* changed by strict_unit_advance() alone */
    enum strict_fate fate;         /* changed by strict_unit_decide() alone */
    bool bottom_done; /* the true bottom was sent */
    bool parked;      /* PARKED was sent or queued, and not taken back by
                       * RESUMED: the coordinator knows that the unit can only
                       * wait, some time after wait.waiting does */
    int out;          /* a TRUTH that ended early handed on the rows of lines
                       * before this one */
    int sent_columns; /* of the true bottom */
    size_t sent_densities;
    struct strict_lending lending;
    struct loan *loan; /* columns that another worker lends; NULL: the unit is
                        * lines */
    struct strict_wait wait;
    struct strict_pass *pass; /* under way; or NULL */
    struct msg_counts spent;  /* by the unit's passes so far */
    struct team_made made;    /* the most that any pass went over */
    uint64_t *cpu_ns; /* time spent, by line from first - 1 on; a team adds to
                       * it during a pass */
    int nlines;       /* length of cpu_ns, lines that were given away included
                       */
    int top_known; /* how many lines the densities above the first line followed
                    * from in the last pass ahead */
    struct strict_guess guess;
    struct strict_chain chain;
};

static inline bool
is_gone(const struct strict_unit *u)
{
    return u->fate == FATE_GONE;
}

/* Do passes ahead go over the base line above the unit, too? */
static inline bool
goes_above(const struct strict_unit *u)
{
    return u->above != ABOVE_LEFT_OUT;
}

/* Is the line the unit's own, or the line whose base line is its top? */
static inline bool
covers(const struct strict_unit *u, uint32_t frame, int line)
{
    return u->frame == frame && line < u->last && line >= u->first - 1;
}

/* A unit of lines [first, last) of a frame, in no machine yet; NULL: memory is
 * out. */
struct strict_unit *strict_unit_new(uint32_t unit, uint32_t attempt,
                                    uint32_t frame, int first, int last);
void strict_unit_free(struct strict_unit *u);

/* Change the unit's progress or fate; the step must be in strict_progress_steps
 * or strict_fate_steps. */
void strict_unit_advance(struct strict_unit *u, enum strict_progress to);
void strict_unit_decide(struct strict_unit *u, enum strict_fate to);
/* The first line that passes ahead make: first, or first - 1 if they make the
 * base line above. */
int strict_unit_top(const struct strict_unit *u);
/* The attempt at the unit, unless it is gone; NULL: it is not here. */
struct strict_unit *strict_unit_find(const struct strict *s, uint32_t unit,
                                     uint32_t attempt);
/* Raise u->made to what a pass has gone over. */
void strict_unit_made(struct strict_unit *u, const struct team_made *made);
/* Is the unit's top here, true and whole, or is none needed? */
bool strict_unit_has_top(const struct strict *s, const struct strict_unit *u);
/* This child's unit whose bottom is u's top; whose top is u's bottom.  NULL: it
 * has none. */
struct strict_unit *strict_unit_above(const struct strict *s,
                                      const struct strict_unit *u);
struct strict_unit *strict_unit_below(const struct strict *s,
                                      const struct strict_unit *u);
/* Put a unit into the machine, as the last; take it out. */
void strict_unit_enter(struct strict *s, struct strict_unit *u);
void strict_unit_leave(struct strict *s, struct strict_unit *u);
/* Let the unit end with line last - 1: it has another bottom now, of which
 * nothing was sent or guessed. */
void strict_unit_end_at(struct strict *s, struct strict_unit *u, int last);

#endif
