/* msg_lending.h - what workers get that have nothing to do, or nothing yet: columns
 * of a line, parts of space, estimates
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_LENDING_H
#define MSG_LENDING_H

#include "proto/msg_work.h"

/* Before the first unit: make the deep ambient records of a part of space, the
 * others making theirs.  Parts are intervals of the order that all of them put
 * what rays meet in (src/picture/seed.h). */
#define MSG_SEED_ALL 65536u
struct msg_seed {
    const uint8_t *job;
    uint32_t first, last; /* from the first up to below the last, of all */
};

/* Lend columns of the unit's last line to another worker. */
struct msg_lend {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint16_t part; /* of what is left of it, in 65536ths */
};

#define MSG_LOAN_LINE  (1u << 0) /* of the base line, too, not the bar alone */
#define MSG_LOAN_FLAGS 1u        /* all of them */

/* Columns of a line that whoever lends them does not trace until BACK; and what
 * it takes to know which of their pixels count.  Up: what comes of LEND, with
 * the lender's unit and attempt.  Down: with those of the one that gets them,
 * who sends FACTS, and PAID when that is all. */
struct msg_loan {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t frame, line;
    uint32_t x, n;        /* columns, at least 1 */
    uint16_t given, left; /* of the line's cost, in 65535ths: that, and what is
                           * the lender's own */
    uint8_t flags;        /* MSG_LOAN_... */
    uint8_t channels;     /* 3 or 4 */
    uint32_t ndensity;    /* with MSG_LOAN_LINE: of the line above, all */
    const uint8_t *density;
    const uint8_t *wanted; /* (n + 7) / 8 bytes: column x + i of the bar is to
                            * be filled if bit i % 8 of byte i / 8 is set */
    const uint8_t *top;    /* base line above, as in the picture: n * channels
                            * floats */
    const uint8_t *bottom; /* without MSG_LOAN_LINE: the base line as it was
                            * sampled; as long */
};

/* Columns that were lent are the lender's again: what there is of them came as
 * FACTS. */
struct msg_back {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t line, x, n; /* n 0: all that it lends */
};

/* All that was lent is traced, and forgotten: what that cost is the unit's. */
struct msg_paid {
    const uint8_t *job;
    uint32_t unit, attempt;
    struct msg_counts counts; /* no primary rays, no nan: the lender has them */
};

/* What a worker spent on lines, for units and loans that are done: processor
 * time of its render threads.  All of a line's are to be added. */
struct msg_line_costs {
    const uint8_t *job;
    uint32_t frame, line; /* the first of them */
    uint32_t nlines;
    const uint64_t *cpu_ns;
};

struct msg_area {
    uint32_t frame; /* index into the job's frames */
    uint32_t x, y, width, height;
};

/* Trace a few random pixels of each area, the same whoever does it. */
struct msg_estimate {
    const uint8_t *job;
    uint32_t id;
    uint32_t rays; /* in each area */
    uint32_t nareas;
    const struct msg_area *areas;
};

struct msg_cost {
    uint64_t rays, tests; /* tests: of intersection */
};

/* What they cost, in the order of the ESTIMATE of that id. */
struct msg_estimated {
    const uint8_t *job;
    uint32_t id;
    uint32_t ncosts;
    const struct msg_cost *costs;
    struct msg_counts counts; /* of all of it; cpu_s and wall_s are there */
};

#endif
