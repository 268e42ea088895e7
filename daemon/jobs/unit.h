/* unit.h - one unit of a job, as the coordinator knows it
 *
 * A unit is a number of the job's partition, which knows where it lies.  The
 * drawing of its states is at the head of unit.c.
 * Thread: one. */
#ifndef DAEMON_UNIT_H
#define DAEMON_UNIT_H

#include "jobs/go.h"
#include "proto/message.h"

struct steps;

enum unit_state {
    UNIT_WAITING, /* in the partition's queue, or not yet cut off by it */
    UNIT_SUSPECT, /* in job.suspects: to go to a worker that has nothing else */
    UNIT_OUT,     /* workers have it */
    UNIT_DONE     /* all its rows are kept */
};
#define UNIT_STATES 4

/* Changed by duplicate.c: hashes of the rows that count. */
struct unit_hashes {
    uint64_t *row; /* NULL: not known */
    uint32_t n;
    uint64_t fingerprint; /* of the worker that made the rows */
};

struct job_unit {
    enum unit_state state; /* by unit_step() alone */
    uint32_t attempt;     /* number of the latest attempt; before the first of
                           * this life of the coordinator, the number after
                           * which its attempts count (unit_first_attempt()) */
    uint32_t tries;       /* how often it went out */
    uint32_t lead;        /* attempt whose rows count; 0: whose come first */
    uint32_t worker;      /* of that attempt, or of the latest */
    uint64_t out_ms;      /* when it went to that worker; 0: in an earlier
                           * life */
    uint32_t next_row;    /* rows that came, and count */
    uint32_t stored_rows; /* of these, kept */
    uint64_t row_ms;      /* when the last of them came */
    uint32_t slot;        /* in job.out */
    struct job_go *go;    /* attempts that are not over, room for JOB_MAX_GOES;
                           * NULL: there are none */
    uint8_t ngos;
    uint8_t crashes;  /* children that it brought down */
    uint32_t crasher; /* worker of the first of these */
    uint8_t faults;   /* attempts that came incomplete */
    uint8_t overtaken; /* times that a twin led in place of a silent attempt */
    uint8_t losses;   /* how often its worker went, and came back without it */
    bool whole;       /* no lines of it can be given away */
    bool given_back;  /* its worker had to: the next one redoes nothing */
    uint64_t end_ms;
    struct unit_hashes hashes;
    struct msg_counts counts; /* of the attempt that was accepted, and lent */
    struct msg_counts lent;   /* of loans that were paid (lending.c) */
};

/* Which state may follow which; see the head of unit.c. */
extern const struct steps unit_steps;
/* Change the unit's state; the step must be in unit_steps.  Called by unit.c
 * and go.c alone. */
void unit_step(struct job_unit *u, enum unit_state to);

/* Attempts are numbered anew in each life of the coordinator, from here on. */
uint32_t unit_first_attempt(const struct job *job);

/* Make job->units as long as the partition has units; false: memory is out. */
bool unit_grow(struct job *job);

/* Take a unit that waits, or is a suspect, out of its queue: it goes out, or
 * its last rows are kept. */
void unit_take(struct job *job, uint32_t unit);
/* Nobody has the unit any more: it waits again. */
void unit_wait(struct job *job, uint32_t unit);
/* All its rows are kept: count them; progress_see() is due then. */
void unit_done(struct job *job, uint32_t unit, uint64_t end_ms);

#endif
