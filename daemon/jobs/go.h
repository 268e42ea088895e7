/* go.h - one worker's attempt at a unit, as the coordinator knows it
 *
 * An attempt begins when the unit goes out to a worker and ends when the worker
 * has nothing more to do with the unit.  A unit that is late has several
 * attempts, of which the first whose rows come leads: its rows count.  An
 * attempt may also be a loan: then it has but columns of the unit's last line,
 * and works for the attempt that lends them.  The drawing of the states is at
 * the head of go.c.
 * Thread: one. */
#ifndef DAEMON_GO_H
#define DAEMON_GO_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct steps;

#define JOB_MAX_HOLDERS 5  /* attempts at one unit that are no loans */
#define JOB_MAX_GOES    13 /* these, and loans */

enum go_state {
    GO_OVER,     /* not begun, or at its end */
    GO_WORKING,  /* its worker traces, or will without waiting for anybody */
    GO_PARKED,   /* it can only wait for the base line above its unit */
    GO_BLOCKED,  /* it can only wait for columns that it lent */
    GO_YIELDING, /* its worker was told to give the unit back (YIELD) */
    GO_DELIVERED /* all rows came, and are on their way to the disk */
};
#define GO_STATES 6

enum go_origin {
    GO_HANDED_OUT,
    GO_RESUMED, /* the worker was at it when it came back (STILL) */
    GO_LOAN
};

enum go_rows {
    GO_MAY_LEAD,
    GO_DROPPED, /* rows came while another attempt led, or it is a loan */
    GO_SPENT    /* all of them came, and none counts */
};

/* Changed by lending.c, but that hold.c counts a loan down when it is over. */
struct go_lending {
    uint32_t lender;     /* of a loan: the attempt that lends */
    uint32_t x, n;       /* of a loan: columns [x, x + n) of the last line */
    uint32_t loans;      /* that the attempt lends, and are not back */
    uint64_t asked_ms;   /* LEND was sent; 0: never, or it was answered */
    uint64_t blocked_ms; /* the first time that it had nothing left but what it
                          * lent; 0: never */
    double line_left;    /* part of the last line that it has yet to do, */
    uint64_t line_ms;    /* then; 0: not known, it never lent */
};

/* Changed by handoff.c and, where the base line is made, by hold.c. */
struct go_handoff {
    bool top_sent;  /* it was sent the base line above, whole, by us */
    bool makes_top; /* it traces the base line above, which nobody else gets */
};

struct job_go {
    uint32_t worker;     /* index in the job */
    uint32_t attempt;    /* its number */
    enum go_state state; /* by go_step() alone */
    enum go_origin origin;
    enum go_rows rows;
    uint32_t lines;     /* that it has of the unit */
    uint8_t end;        /* where it begins them, enum msg_end */
    bool twin;          /* its worker knows that others have the unit */
    bool counted;       /* its work is in job.finished (speed.c) */
    uint64_t out_ms;    /* handed out */
    uint64_t parked_ms; /* PARKED came, or YIELD was sent; 0: neither */
    uint64_t split_ms;  /* SPLIT was sent (balance.c); 0: or answered */
    uint64_t yield_ms;  /* YIELD was sent (yield.c) */
    struct go_lending lending;
    struct go_handoff handoff;
};

/* Which state may follow which; see the head of go.c. */
extern const struct steps go_steps;
/* Change the attempt's state; the step must be in go_steps.  Called by hold.c
 * alone: its counts of a worker's attempts go by their states. */
void go_step(struct job_go *go, enum go_state to);

/* Has its worker something to do for the unit? */
bool go_works(const struct job_go *go);

/* Is it parked, blocked or yielding? */
bool go_waits(const struct job_go *go);

/* Add an attempt at a unit, or remove one, which moves another; NULL when there
 * are too many or memory is out. */
struct job_go *go_add(struct job *job, uint32_t unit);
void go_remove(struct job *job, uint32_t unit, struct job_go *go);

/* The attempt of that worker; of that worker and number; of that number.  NULL:
 * there is none. */
struct job_go *go_of_worker(const struct job *job, uint32_t unit,
                            uint32_t worker);
struct job_go *go_find(const struct job *job, uint32_t unit, uint32_t worker,
                       uint32_t attempt);
struct job_go *go_of_attempt(const struct job *job, uint32_t unit,
                             uint32_t attempt);

#endif
