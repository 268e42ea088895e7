/* unit.h - one unit of a job, as the coordinator knows it
 *
 * A unit is known by its number in the job's partition, which knows its area.
 * The states are drawn at the head of unit.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_UNIT_H
#define DAEMON_UNIT_H

#include "jobs/attempt.h"
#include "proto/message.h"

struct steps;

enum unit_state {
    UNIT_WAITING, /* in the partition's queue, or part of a run or region from
                   * which the partition has not cut it off yet */
    UNIT_SUSPECT, /* in job.suspects: goes to a worker that has nothing else */
    UNIT_OUT,     /* one worker or more have attempts at it */
    UNIT_DONE     /* all its rows are on the disk */
};
#define UNIT_STATES 4

/* Hashes of the rows that count; changed by duplicate.c alone. */
struct unit_hashes {
    uint64_t *row;        /* NULL: not kept */
    uint32_t n;           /* length of row */
    uint64_t fingerprint; /* of the worker that made the rows */
};

/* Children that a piece of work, a unit or a tile, brought down. */
struct unit_crashes {
    uint8_t n;
    uint32_t worker; /* of the first of these children: index in job.parts */
};

struct job_unit {
    enum unit_state state; /* changed by unit_step() alone */
    uint32_t latest;       /* number of the latest attempt; before the first in
                            * this life of the coordinator, the number after
                            * which this life begins (unit_first_attempt()) */
    uint32_t tries;        /* how often the unit went out */
    uint32_t lead;   /* number of the attempt whose rows count; 0: open, the
                      * attempt whose rows come first will lead */
    uint32_t part;   /* of the leading attempt's worker, else of the latest's:
                      * index in job.parts */
    uint64_t out_ms; /* when the unit went out to that worker; 0: in an earlier
                      * life of the coordinator */
    uint32_t next_row;    /* rows of the lead that came */
    uint32_t stored_rows; /* of these, rows that are on the disk */
    uint64_t row_ms;      /* when the last of these rows came */
    uint32_t slot;        /* the unit's place in job.out, while UNIT_OUT */
    struct job_attempt *attempts; /* that are not over, with room for
                                   * JOB_MAX_ATTEMPTS; NULL: there are none */
    uint8_t nattempts;
    struct unit_crashes crashes;
    uint8_t faults;    /* attempts that came incomplete */
    uint8_t overtaken; /* how often a twin became the lead because the lead sent
                        * nothing; bounded */
    uint8_t losses;    /* how often in a row the unit's worker was lost; 0 again
                        * when another worker has the unit, or that worker goes
                        * on with it (loss.c) */
    bool whole;        /* no lines of the unit can be given away */
    bool given_back;   /* a worker was told to give the unit back, so its next
                        * attempt does not count as redone */
    uint64_t end_ms;   /* when the last row was on the disk */
    struct unit_hashes hashes;
    struct msg_counts counts; /* of the accepted attempt, and of lent */
    struct msg_counts lent;   /* of loans that were paid (lending.c) */
};

/* Which state may follow which; see the head of unit.c. */
extern const struct steps unit_steps;
/* Change the unit's state; the step must be in unit_steps.  Called by unit.c
 * and attempt.c alone. */
void unit_step(struct job_unit *u, enum unit_state to);

/* The number after which attempts of this life of the coordinator begin. */
uint32_t unit_first_attempt(const struct job *job);

/* Make job->units as long as the partition has units; false: memory is out. */
bool unit_grow(struct job *job);

/* Take a waiting or suspect unit out of its queue, and make it UNIT_OUT: the
 * unit goes out, or all its rows turn out to be kept. */
void unit_take(struct job *job, uint32_t unit);
/* Put a unit without attempts back into the queue, or among the suspects. */
void unit_wait(struct job *job, uint32_t unit);
/* Note that a child of the worker died of the work; false: it has brought down
 * children of two workers, or too many of one, and so fails its job. */
bool unit_crashed(struct unit_crashes *crashes, uint32_t index);
/* All the unit's rows are on the disk: count it as done.  The caller calls
 * progress_see() after that. */
void unit_done(struct job *job, uint32_t unit, uint64_t end_ms);

#endif
