/* strict_state.h - what the strict units' machine knows
 *
 * Private to strict*.c, as are the headers of these files.  Calls go down:
 *   strict.c        the machine's beginning and end, and what it counts
 *   strict_pass.c   the next pass: of which unit, in which mode; how it ends
 *   strict_order.c  orders about units: UNIT, SPLIT, YIELD, REVOKE, TWIN
 *   strict_loan.c   columns that are lent, and that others lend
 *   strict_rank.c   which unit comes first
 *   strict_out.c    messages that go out
 *   strict_facts.c  facts by line
 *   strict_unit.c   states of a unit (drawn in strict_unit.h); units by number
 *                   and by line
 *   strict_edge.c   tops and bottoms by line
 * Units, facts and edges are found by frame and line.
 * Thread: under the lock of strict.h, but for facts that a team is at. */
#ifndef DAEMON_STRICT_STATE_H
#define DAEMON_STRICT_STATE_H

#include "strict/strict_unit.h"

#include <stdatomic.h>

/* Units and edges are found by frame and line in tables of so many slots: a
 * child may have thousands of units that wait. */
#define STRICT_SLOTS 1024

/* A message that is to be sent; of FACTS one or more. */
enum item_kind {
    ITEM_FACTS,
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
    uint32_t unit, attempt; /* of all but PIECE and LINE_COSTS */
    uint32_t height;        /* of GAVE */
    uint32_t frame;
    int line;
    int row;                  /* of FACTS: those of rows above were sent */
    uint32_t x, n;            /* of PIECE */
    uint32_t first, ndensity; /* of PIECE */
    uint8_t *bytes;           /* of PIECE: densities, then pixels */
    uint32_t nlines;          /* of LINE_COSTS, from line on */
    uint64_t *cpu_ns;         /* of LINE_COSTS: nlines values */
    struct msg_loan loan;     /* of LOAN; its pointers are into bytes */
    struct msg_counts counts; /* of PAID */
};

/* A line whose facts came before its unit, as they do for a unit that another
 * worker had before. */
struct early {
    struct early *next; /* the next later line */
    uint32_t frame;
    int line;
    size_t bytes;
};

struct queue {
    struct item *first, *last; /* NULL: there is none */
};

struct frame {
    struct rad_quincunx q;
    size_t ndensity;
    int nlines;
    _Atomic(struct rad_facts *) *facts; /* by line; NULL: none needed yet */
};

struct strict {
    uint8_t job[MSG_JOB];
    struct frame *frames;
    uint32_t nframes;
    bool painted;
    struct strict_unit *units;
    struct strict_unit *by_first[STRICT_SLOTS], *by_last[STRICT_SLOTS];
    struct edge *edges; /* strict_edge.h; the oldest first */
    struct edge *by_line[STRICT_SLOTS];
    struct early *early, **early_end;
    size_t early_bytes;
    struct queue urgent, lazy;
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

/* The first row of the lines from i on: nlines gives the height. */
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

#endif
