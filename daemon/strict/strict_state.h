/* strict_state.h - the state of the strict units' machine
 *
 * Private to strict*.c, as are the headers of these files.  Calls go down:
 *   strict.c        the machine's beginning and end, and what it counts
 *   strict_pass.c   the next pass: of which unit, in which mode; how it ends
 *   strict_order.c  orders about units: UNIT, SPLIT, YIELD, REVOKE
 *   strict_loan.c   columns that are lent, and that are borrowed
 *   strict_rank.c   which unit comes first
 *   strict_guess.c  guesses at tops and bottoms
 *   strict_out.c    messages that go
 *   strict_facts.c  facts by line
 *   strict_unit.c   states of a unit (drawn in strict_unit.h); units by number
 *                   and by line
 *   strict_edge.c   tops and bottoms by line
 * Thread: under the lock of strict.h, but for facts that a team works on. */
#ifndef DAEMON_STRICT_STATE_H
#define DAEMON_STRICT_STATE_H

#include "strict/strict_unit.h"

#include <stdatomic.h>

/* Slots of the tables by frame and line: a child may have thousands of units
 * that wait. */
#define STRICT_SLOTS 1024

/* The message that an item becomes; ITEM_FACTS become several. */
enum item_kind {
    ITEM_FACTS,
    ITEM_GUESS,
    ITEM_PARKED,
    ITEM_RESUMED,
    ITEM_GAVE,
    ITEM_PIECE,
    ITEM_LOAN,
    ITEM_PAID,
    ITEM_LINE_COSTS
};

struct item {
    struct item *next;
    enum item_kind kind;
    uint32_t unit, attempt; /* of all but GUESS, PIECE and LINE_COSTS */
    uint32_t height;        /* of GAVE */
    uint32_t frame;
    int line;
    int row;                  /* of FACTS: rows above it were sent */
    uint32_t x, n;            /* of PIECE: columns [x, x + n); of GUESS n is how
                               * many lines are known */
    uint32_t first, ndensity; /* of PIECE and GUESS: densities */
    uint8_t *bytes;           /* of PIECE: densities, then pixels; of GUESS:
                               * densities */
    uint32_t nlines;          /* of LINE_COSTS: lines from .line on */
    uint64_t *cpu_ns;         /* of LINE_COSTS: nlines values */
    struct msg_loan loan;     /* of LOAN; its pointers lead into bytes */
    struct msg_counts counts; /* of PAID */
};

/* A line whose facts came before its unit, as they do for a unit that another
 * worker had. */
struct early {
    struct early *next; /* the next line in the order in which they came */
    uint32_t frame;
    int line;
    size_t bytes;
};

struct queue {
    struct item *first, *last; /* NULL: empty */
};

struct frame {
    struct rad_quincunx q;
    size_t ndensity;
    int nlines;
    _Atomic(struct rad_facts *) *facts; /* by line; NULL: not needed yet */
};

struct strict {
    uint8_t job[MSG_JOB];
    struct frame *frames;
    uint32_t nframes;
    bool painted; /* base lines may be painted over */
    struct strict_unit *units;
    /* by the slot of their first line; of the line after their last */
    struct strict_unit *by_first[STRICT_SLOTS], *by_last[STRICT_SLOTS];
    struct edge *edges; /* strict_edge.h; the oldest first */
    struct edge *by_line[STRICT_SLOTS];
    struct early *early, **early_end;
    size_t early_bytes;
    struct queue urgent, lazy; /* strict_out.c */
    struct msg_counts dropped;
    struct item *saying; /* owns the memory that msg points to */
    struct msg msg;
    uint8_t *bitmap, *bytes; /* of the message */
    float *floats;
    size_t bitmap_room, floats_room;
    int error;
};

static inline const struct frame *
frame_of(const struct strict *s, uint32_t frame)
{
    return &s->frames[frame];
}

static inline int
channels_of(const struct frame *f)
{
    return f->q.depth ? 4 : 3;
}

/* The first row of line i; of line nlines the frame's height. */
static inline int
row_of(const struct frame *f, int i)
{
    return i < f->nlines ? team_line_row(&f->q, i) : f->q.height;
}

static inline size_t
slot_of(uint32_t frame, int line)
{
    return (frame * 31 + (uint32_t)line) % STRICT_SLOTS;
}

/* Is there such a line, with another below, for which it can be a top? */
static inline bool
is_above_a_line(const struct strict *s, uint32_t frame, uint32_t line)
{
    return frame < s->nframes &&
           line < (uint32_t)frame_of(s, frame)->nlines - 1;
}

/* This child's unit whose lines begin there, unless it is gone; NULL: none. */
static inline struct strict_unit *
unit_from(const struct strict *s, uint32_t frame, int first)
{
    struct strict_unit *u = s->by_first[slot_of(frame, first)];

    while (u && (is_gone(u) || u->frame != frame || u->first != first))
        u = u->same_first;
    return u;
}

#endif
