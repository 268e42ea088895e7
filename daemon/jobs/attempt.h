/* attempt.h - one worker's attempt at a unit, as the coordinator knows it
 *
 * An attempt begins when the unit goes out to a worker and ends when the worker
 * has nothing more to do with the unit.  A unit that is late gets further
 * attempts.  The attempt whose rows come first leads: its rows count.  A loan
 * is an attempt, too: it has some columns of the unit's last line, and works
 * for the attempt that lends these.  The states are drawn at the head of
 * attempt.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ATTEMPT_H
#define DAEMON_ATTEMPT_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct steps;

#define JOB_MAX_HOLDERS  5  /* attempts at one unit, loans left out */
#define JOB_MAX_ATTEMPTS 13 /* attempts at one unit, loans included */

enum attempt_state {
    ATTEMPT_OVER,     /* not begun, or ended */
    ATTEMPT_WORKING,  /* the worker traces, or can, without waiting for anybody
                       */
    ATTEMPT_PARKED,   /* the worker can only wait for the base line above the
                       * unit */
    ATTEMPT_BLOCKED,  /* the worker can only wait for columns that it lent */
    ATTEMPT_YIELDING, /* the worker was told to give the unit back (YIELD) */
    ATTEMPT_DELIVERED /* all rows came, and are on their way to the disk */
};
#define ATTEMPT_STATES 6

enum attempt_origin {
    ATTEMPT_HANDED_OUT,
    ATTEMPT_RESUMED, /* a worker that connected again named the unit (STILL) */
    ATTEMPT_LOAN
};

/* May rows of the attempt count? */
enum attempt_rows {
    ATTEMPT_MAY_LEAD,
    ATTEMPT_DROPPED, /* no: another attempt led when the rows came, or the
                      * attempt is a loan */
    ATTEMPT_SPENT    /* no, and the attempt's last row has come */
};

/* Changed by lending.c; holding.c counts loans down when one ends. */
struct attempt_lending {
    uint32_t lender;     /* of a loan: the number of the attempt that lends */
    uint32_t x, n;       /* of a loan: columns [x, x + n) of the last line */
    uint32_t loans;      /* loans of this attempt's columns that are not over */
    uint64_t asked_ms;   /* when LEND was sent; 0: never, or LEND was answered
                          */
    uint64_t blocked_ms; /* when the attempt first had nothing left but columns
                          * that it lent; 0: never */
    double line_left;    /* part of the last line that was left at line_ms */
    uint64_t line_ms;    /* when line_left was told; 0: never, for the attempt
                          * lent nothing */
};

/* Changed by handoff.c; holding.c clears makes_top when the base line is made.
 */
struct attempt_handoff {
    bool top_sent;  /* the coordinator sent the attempt's worker the whole base
                     * line above the unit */
    bool makes_top; /* the attempt traces the base line above the unit; other
                     * workers do not get that line's unit meanwhile */
};

struct job_attempt {
    uint32_t unit;   /* the attempt is at this unit; set by attempt_add() */
    uint32_t number; /* of the attempt, unique for the unit */
    uint32_t part;   /* index in job.parts: whose attempt it is */
    enum attempt_state state; /* changed by attempt_step() alone */
    enum attempt_origin origin;
    enum attempt_rows rows;
    bool counted;       /* the unit's cost is in job.speed.finished (speed.c) */
    uint64_t out_ms;    /* when the unit went out to the worker */
    uint64_t parked_ms; /* when the attempt last began to wait, or PARKED came
                         * while its top was on its way; 0: never */
    uint64_t split_ms;  /* when SPLIT was sent (balance.c); 0: never, or SPLIT
                         * was answered */
    uint64_t yield_ms;  /* when YIELD was sent (yield.c) */
    struct attempt_lending lending;
    struct attempt_handoff handoff;
};

/* Which state may follow which; see the head of attempt.c. */
extern const struct steps attempt_steps;
/* Change the attempt's state; the step must be in attempt_steps.  Only for
 * holding_step(), which also counts a worker's attempts by their states. */
void attempt_step(struct job_attempt *attempt, enum attempt_state to);

/* Is the attempt ATTEMPT_WORKING? */
bool attempt_works(const struct job_attempt *attempt);

/* Is the attempt parked, blocked or yielding? */
bool attempt_waits(const struct job_attempt *attempt);

/* Add an attempt at a unit, which is then UNIT_OUT and in job->out; all but
 * its unit is 0.  NULL: the unit has too many attempts, or memory is out. */
struct job_attempt *attempt_add(struct job *job, uint32_t unit);
/* Remove an attempt.  Its unit's last attempt moves to its place; a unit
 * without attempts leaves job->out. */
void attempt_remove(struct job *job, struct job_attempt *attempt);

/* A walk over all attempts of a job: walk = attempt_walk(job), then
 * attempt_next() until it returns NULL.  The attempt that was returned last may
 * be ended, and others at its unit with it. */
struct attempt_walk {
    uint32_t left; /* the first so many of job.out are to come */
    uint32_t unit; /* of this one */
    uint8_t n;     /* the first so many attempts are to come */
};
struct attempt_walk attempt_walk(const struct job *job);
struct job_attempt *attempt_next(const struct job *job,
                                 struct attempt_walk *walk);

/* The first of the unit's attempts that is no loan; NULL: there is none. */
struct job_attempt *attempt_first(const struct job *job, uint32_t unit);
/* Find the unit's attempt by its part, by part and number, or by number.
 * NULL: there is none. */
struct job_attempt *attempt_of_part(const struct job *job, uint32_t unit,
                                    uint32_t part);
struct job_attempt *attempt_find(const struct job *job, uint32_t unit,
                                 uint32_t part, uint32_t number);
struct job_attempt *attempt_of_number(const struct job *job, uint32_t unit,
                                      uint32_t number);

#endif
