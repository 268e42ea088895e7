/* strict_impl.h - what the files of the strict units' machine share
 *
 * Private to strict*.c:
 *   strict.c        set-up and end
 *   strict_unit.c   units, and what is told of them
 *   strict_pass.c   what is done for a unit next
 *   strict_loan.c   columns that are lent, and that others lend
 *   strict_facts.c  facts by line
 *   strict_edge.c   tops and bottoms by line
 *   strict_out.c    messages that go out
 * Everything is found by frame and line. */
#ifndef DAEMON_STRICT_IMPL_H
#define DAEMON_STRICT_IMPL_H

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

/* --- strict_unit.c --- */

/* It has no pass: forget it, its facts and what it was to send. */
void unit_drop(struct strict *s, struct strict_unit *u);
void unit_free(struct strict_unit *u);
/* What a pass of it has gone over. */
void unit_made(struct strict_unit *u, const struct team_made *made);
/* Room to count what its lines cost; false: memory is out. */
bool unit_count_lines(struct strict_unit *u);
bool unit_has_top(const struct strict *s, const struct strict_unit *u);
/* The unit here whose bottom is this one's top, or the other way round; NULL:
 * none. */
struct strict_unit *unit_above(const struct strict *s,
                               const struct strict_unit *u);
struct strict_unit *unit_below(const struct strict *s,
                               const struct strict_unit *u);
/* Give half of a unit that no team is at, or all of it: then it is gone. */
void unit_split_idle(struct strict *s, struct strict_unit *u);
void unit_hand_back(struct strict *s, struct strict_unit *u);
/* Lines from `last` on are no longer the unit's; say so. */
void unit_give_lines(struct strict *s, struct strict_unit *u, int last);
/* Send what others may wait for of the base line above. */
void unit_say_top(struct strict *s, const struct strict_unit *u);
/* If it can only wait, say so at once: its thread has room for another. */
void unit_park(struct strict *s, struct strict_unit *u);

/* Of that number, and not gone; NULL: none. */
struct strict_unit *unit_find(const struct strict *s, uint32_t unit,
                              uint32_t attempt);

/* --- strict_loan.c --- */

/* Are columns of it lent? */
bool loan_is_out(const struct strict_unit *u);
void loan_free(struct loan *l);
/* What another worker lends is traced, or goes back: its lender gets it. */
void loan_end(struct strict *s, struct strict_unit *u);

/* --- strict_pass.c --- */

/* Can it do nothing but wait for its top? */
bool pass_waits(const struct strict *s, const struct strict_unit *u);
/* The tops that this edge was: stop what goes on without it; and so on for
 * bottoms that thereby are true. */
void pass_top_came(struct strict *s, const struct edge *e);
/* What others wait for is due: have a thread leave what is less urgent. */
void pass_make_way(struct strict *s);

/* --- strict_facts.c --- */

/* NULL: there are none. */
struct rad_facts *facts_at(const struct strict *s, uint32_t frame, int line);
/* Room for the facts of a frame's lines; teams look there for new ones.  False:
 * memory is out, here and below. */
bool facts_make_table(struct strict *s, uint32_t frame);
bool facts_make_all(struct strict *s, const struct strict_unit *u);
/* Are there some of each of its lines? */
bool facts_have_all(const struct strict *s, const struct strict_unit *u);
/* The unit's first bar can be traced ahead if there are such of the base line
 * above. */
void facts_use_above(struct strict *s, struct strict_unit *u);
/* Free those of a line, if nobody needs them. */
void facts_drop(struct strict *s, uint32_t frame, int line);
/* With many frames, do not keep what those that are done had. */
void facts_drop_table(struct strict *s, uint32_t frame);
/* Facts of a unit that go with it, and nobody was told of; and those of its
 * lines that are there for nothing, with the top that it made in vain. */
uint64_t facts_untold(const struct strict *s, const struct strict_unit *u);
uint64_t facts_unused(const struct strict *s, const struct strict_unit *u);
/* What another worker had traced first of a loan's line; counted here if no
 * unit of that line is. */
uint64_t facts_late(const struct strict *s, const struct strict_unit *u);
void facts_release(struct strict *s);

/* --- strict_edge.c --- */

struct edge *edge_find(const struct strict *s, uint32_t frame, int line);
/* NULL: memory is out. */
struct edge *edge_make(struct strict *s, uint32_t frame, int line);
/* Free it, if no unit needs it. */
void edge_drop(struct strict *s, uint32_t frame, int line);
void edge_pixel(struct edge *e, int x, const struct rad_pixel *p);
void edge_density(struct edge *e, const struct frame *f, size_t d,
                  uint8_t density);
void edge_release(struct strict *s);

/* --- strict_out.c --- */

void out_release(struct strict *s);
/* Send the facts of a line that are new, once. */
void out_facts(struct strict *s, struct queue *q, const struct strict_unit *u,
               int line);
/* Do facts of that line wait to be sent, wanted by others? */
bool out_has_facts(const struct strict *s, uint32_t frame, int line);
/* Lines before `last` are left of it. */
void out_gave(struct strict *s, const struct strict_unit *u, int last);
void out_parked(struct strict *s, const struct strict_unit *u);
void out_resumed(struct strict *s, const struct strict_unit *u);
void out_paid(struct strict *s, const struct strict_unit *u);
/* What was spent on each line for a unit or loan that is done. */
void out_line_costs(struct strict *s, const struct strict_unit *u);
void out_loan(struct strict *s, const struct strict_unit *u,
              const struct team_loan *loan);
/* What is new of the bottom of a pass. */
void out_piece(struct strict *s, const struct strict_pass *p, int columns,
               size_t densities, const struct rad_pixel *pixels,
               const uint8_t *density);
/* All of a unit's bottom; first of all where nobody here waits for it. */
void out_bottom(struct strict *s, const struct strict_unit *u,
                const struct rad_pixel *pixels, const uint8_t *density);
/* Nobody needs the facts of a parked unit any more. */
void out_forget(struct strict *s, const struct strict_unit *u);

#endif
