/* go.h - one worker's attempt at a unit, as the coordinator knows it
 *
 * An attempt begins when the unit goes out to a worker and ends when the worker
 * has nothing more to do with the unit.  A unit that is late gets further
 * attempts.  The attempt whose rows come first leads: its rows count.  A loan
 * is an attempt, too: it has some columns of the unit's last line, and works
 * for the attempt that lends these.  The states are drawn at the head of go.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_GO_H
#define DAEMON_GO_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct steps;

#define JOB_MAX_HOLDERS 5  /* attempts at one unit, loans left out */
#define JOB_MAX_GOES    13 /* attempts at one unit, loans included */

enum go_state {
    GO_OVER,     /* not begun, or ended */
    GO_WORKING,  /* the worker traces, or can without waiting for another */
    GO_PARKED,   /* the worker can only wait for the base line above the unit */
    GO_BLOCKED,  /* the worker can only wait for columns that it lent */
    GO_YIELDING, /* the worker was told to give the unit back (YIELD) */
    GO_DELIVERED /* all rows came, and are on their way to the disk */
};
#define GO_STATES 6

enum go_origin {
    GO_HANDED_OUT,
    GO_RESUMED, /* a worker that connected again named the unit (STILL) */
    GO_LOAN
};

/* May rows of the attempt count? */
enum go_rows {
    GO_MAY_LEAD,
    GO_DROPPED, /* no: another attempt led when the rows came, or the attempt is
                 * a loan */
    GO_SPENT    /* no, and the attempt's last row has come */
};

/* Changed by lending.c; holding.c counts loans down when one ends. */
struct go_lending {
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
struct go_handoff {
    bool top_sent;  /* the coordinator sent the attempt's worker the whole base
                     * line above the unit */
    bool makes_top; /* the attempt traces the base line above the unit; other
                     * workers do not get that line's unit meanwhile */
};

struct job_go {
    uint32_t unit;       /* the attempt is at this unit; set by go_add() */
    uint32_t attempt;    /* number of the attempt, unique for the unit */
    uint32_t worker;     /* index in job.workers */
    enum go_state state; /* changed by go_step() alone */
    enum go_origin origin;
    enum go_rows rows;
    uint8_t end;        /* where on a line tracing begins, enum msg_end */
    bool twin;          /* the worker was told that others have the unit */
    bool counted;       /* the unit's cost is in job.speed.finished (speed.c) */
    uint64_t out_ms;    /* when the unit went out to the worker */
    uint64_t parked_ms; /* when the attempt last began to wait (go_waits()), or
                         * PARKED came while its top was on its way; 0: never */
    uint64_t split_ms;  /* when SPLIT was sent (balance.c); 0: never, or SPLIT
                         * was answered */
    uint64_t yield_ms;  /* when YIELD was sent (yield.c) */
    struct go_lending lending;
    struct go_handoff handoff;
};

/* Which state may follow which; see the head of go.c. */
extern const struct steps go_steps;
/* Change the attempt's state; the step must be in go_steps.  Only for
 * holding_step(), which also counts a worker's attempts by their states. */
void go_step(struct job_go *go, enum go_state to);

/* Is the attempt GO_WORKING? */
bool go_works(const struct job_go *go);

/* Is the attempt parked, blocked or yielding? */
bool go_waits(const struct job_go *go);

/* Add an attempt at a unit, which is then UNIT_OUT and in job->out; all but
 * its unit is 0.  NULL: the unit has too many attempts, or memory is out. */
struct job_go *go_add(struct job *job, uint32_t unit);
/* Remove an attempt.  Its unit's last attempt moves to its place; a unit
 * without attempts leaves job->out. */
void go_remove(struct job *job, struct job_go *go);

/* Find the unit's attempt by its worker, by worker and number, or by number.
 * NULL: there is none. */
struct job_go *go_of_worker(const struct job *job, uint32_t unit,
                            uint32_t worker);
struct job_go *go_find(const struct job *job, uint32_t unit, uint32_t worker,
                       uint32_t attempt);
struct job_go *go_of_attempt(const struct job *job, uint32_t unit,
                             uint32_t attempt);

#endif
