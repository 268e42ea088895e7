/* msg_lending.h - columns of a line that are lent to idle workers; costs of
 * lines and estimates of them
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_LENDING_H
#define MSG_LENDING_H

#include "proto/msg_work.h"

/* Lend columns of the unit's last line to another worker. */
struct msg_lend {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint16_t part; /* of the line's part that is left, in 65536ths */
};

#define MSG_LOAN_LINE  (1u << 0) /* of bar and base line, not the bar alone */
#define MSG_LOAN_FLAGS 1u        /* all of them */

/* Columns of a line that the lender does not trace until BACK, with the rows
 * that decide which of their pixels are traced.  From the lender: its answer to
 * LEND, with its own unit and attempt.  To the borrower: with an attempt of the
 * borrower's at the same unit; it answers by FACTS, and then PAID. */
struct msg_loan {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t frame, line;
    uint32_t x, n;        /* columns, at least 1 */
    uint16_t given, left; /* shares of the line's cost, in 65535ths: of these
                           * columns; of the columns that the lender keeps and
                           * has not begun */
    uint8_t flags;        /* MSG_LOAN_... */
    uint8_t channels;     /* 3 or 4 */
    uint32_t ndensity;    /* with MSG_LOAN_LINE: all densities of the line
                           * above; else 0 */
    const uint8_t *density;
    const uint8_t *wanted; /* (n + 7) / 8 bytes: column x + i of the bar is to
                            * be filled if bit i % 8 of byte i / 8 is set */
    const uint8_t *top;    /* the base line above, as in the picture: n *
                            * channels floats */
    const uint8_t *bottom; /* without MSG_LOAN_LINE: this line's base line, as
                            * it was sampled; as long */
};

/* The lender has its columns back.  All known facts of their pixels have come
 * before, as FACTS. */
struct msg_back {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t line, x, n; /* n 0: all columns that the unit lends */
};

/* From the borrower: it has traced the columns of a LOAN and dropped them;
 * their cost belongs to the unit. */
struct msg_paid {
    const uint8_t *job;
    uint32_t unit, attempt;
    struct msg_counts counts; /* without primary rays and nan, which the lender
                               * counts */
};

/* Processor time of a worker's render threads for lines of units and loans that
 * are done.  Costs of one line from several messages are to be added. */
struct msg_line_costs {
    const uint8_t *job;
    uint32_t frame, line; /* the first line */
    uint32_t nlines;
    const uint64_t *cpu_ns;
};

struct msg_area {
    uint32_t frame; /* index into the job's frames */
    uint32_t x, y, width, height;
};

/* Trace a few random pixels of each area; every worker chooses the same ones.
 */
struct msg_estimate {
    const uint8_t *job;
    uint32_t id;
    uint32_t rays; /* rays in each area */
    uint32_t nareas;
    const struct msg_area *areas;
};

struct msg_cost {
    uint64_t rays, tests; /* tests: intersection tests */
};

/* The costs of the areas, in the order of the ESTIMATE with that id. */
struct msg_estimated {
    const uint8_t *job;
    uint32_t id;
    uint32_t ncosts;
    const struct msg_cost *costs;
    struct msg_counts counts; /* the sum of all areas, with cpu_s and wall_s */
};

#endif
