/* strict_state.h - what the strict units' machine knows
 *
 * Private to strict*.c.  Everything is found by frame and line. */
#ifndef DAEMON_STRICT_STATE_H
#define DAEMON_STRICT_STATE_H

#include "strict/strict.h"

#include <stdatomic.h>

/* Units and edges are found by frame and line in tables of so many slots: a
 * child may have thousands of units that wait. */
#define STRICT_SLOTS 1024

/* The base line under some unit, true. */
struct edge {
    struct edge *next;    /* the newer one */
    struct edge *chained; /* in its slot */
    uint32_t frame;
    int line;
    struct rad_pixel *pixels; /* the width */
    uint8_t *density;
    uint8_t *have;  /* by column, then by density: it is there */
    size_t missing; /* how many are not */
};

struct strict_unit {
    struct strict_unit *next;
    struct strict_unit *same_first, *same_last; /* in their slots; the newer */
    uint32_t unit, attempt, frame;
    int first, last; /* lines [first, last) */
    enum team_end end;
    bool make_top;  /* base line first - 1 is traced ahead here too, since
                     * nobody else does */
    bool knows_top; /* it is gone over ahead with the facts of whoever has it,
                     * which are all that a guess wants */
    bool twin;      /* facts go out as they are made */
    bool gone;      /* to be freed when its pass has ended */
    bool over;      /* what it cost is told: all its rows are made, or PAID */
    bool split;     /* GAVE is due when its pass has ended */
    bool yield;     /* it goes back when its pass has ended */
    bool bars;      /* bars are made along with the lines */
    int filled;     /* lines before it have their bars, as facts, from LINES */
    bool lines_done, ahead_done;
    bool bottom_done;        /* the bottom is out, true */
    bool ahead_guessed;      /* AHEAD had colours above the first bar */
    bool parked;             /* said, or about to be */
    struct team_blocks lent; /* of line last - 1, to other workers */
    double lend;             /* a part of it is asked for; 0: none is */
    bool blocked;            /* TRUTH has done all but these */
    int out;                 /* lines before it were handed on, by TRUTH that
                              * ended early */
    int sent_columns;        /* of the bottom, true */
    size_t sent_densities;
    struct loan *loan; /* what another worker lends, which is all that there is
                        * of this unit; NULL: it is one */
    bool kept;         /* facts went out in case it is lost, or are about to */
    bool waiting;
    uint64_t since_ms; /* waiting: from when */
    struct strict_pass *pass;
    struct msg_counts spent; /* by its passes so far */
    struct team_made made;   /* the most that one of them went over */
    uint64_t *cpu_ns; /* of that, by line, its top's first; a team adds to
                       * it during a pass */
    int nlines;       /* so many; it may have given some away */
    /* its bottom after LINES or AHEAD; NULL: none yet */
    struct rad_pixel *guess;
    uint8_t *guess_density;
    /* densities after lines [chain_first, chain_last), each made from those of
     * the line above, all over facts that are here */
    uint8_t *chain;
    int chain_first, chain_last;
    uint8_t *guess_above; /* the densities that it follows from; NULL: it was
                           * made of nothing */
    int guess_known;      /* lines that it is made of, at most TEAM_SURE */
};

/* Columns that another worker lends, and what its pixels point to. */
struct loan {
    struct team_loan is;
    struct rad_pixel *pixels;
    uint8_t *bytes;
};

/* Something to send. */
struct item {
    struct item *next;
    enum {
        ITEM_FACTS,
        ITEM_PARKED,
        ITEM_RESUMED,
        ITEM_GAVE,
        ITEM_PIECE,
        ITEM_LOAN,
        ITEM_PAID,
        ITEM_LINE_COSTS
    } kind;
    uint32_t unit, attempt; /* of PARKED, GAVE and PAID, and of lazy FACTS */
    uint32_t height;        /* of GAVE */
    uint32_t frame;
    int line;
    int row;                  /* of FACTS: those above are out */
    uint32_t x, n;            /* of PIECE */
    uint32_t first, ndensity; /* of PIECE */
    uint8_t *bytes;           /* of PIECE: densities, then pixels */
    uint32_t nlines;          /* of LINE_COSTS, from line on */
    uint64_t *cpu_ns;         /* of LINE_COSTS: so many */
    struct msg_loan loan;     /* of LOAN; bytes: what it points to */
    struct msg_counts counts; /* of PAID */
};

/* A line whose facts came before a unit that has it, as they do with a unit
 * that others were at. */
struct early {
    struct early *next; /* the later one */
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
    struct edge *edges; /* the oldest first */
    struct edge *by_line[STRICT_SLOTS];
    struct early *early, **early_end;
    size_t early_bytes;
    struct queue urgent, lazy;
    struct msg_counts dropped;
    struct item *saying; /* what the message lies in */
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

/* Its own lines, and the one whose base line is its top. */
static inline bool
covers(const struct strict_unit *u, uint32_t frame, int line)
{
    return u->frame == frame && line < u->last && line >= u->first - 1;
}

static inline size_t
slot_of(uint32_t frame, int line)
{
    return (frame * 31 + (uint32_t)line) % STRICT_SLOTS;
}

#endif
