/* part.h - a worker's part in a job
 *
 * A worker of the job keeps its index for the job's life, gone or not, so that
 * what it did stays counted.  The drawing of the states is at the head of
 * part.c.
 * Thread: one. */
#ifndef DAEMON_PART_H
#define DAEMON_PART_H

#include "proto/message.h"

#include <stdbool.h>
#include <stdint.h>

struct coord_worker;
struct job;
struct steps;

#define JOB_NOBODY UINT32_MAX

enum part_state {
    PART_GONE,     /* it has no connection, or was not told of the job */
    PART_NO_ROOM,  /* its disk is full: not started before it says otherwise */
    PART_EXCLUDED, /* --same-bits, and it computes otherwise; or it cannot keep
                    * a child: not started any more */
    PART_LOADING,  /* JOB_START was sent */
    PART_READY
};
#define PART_STATES 5

struct job_worker {
    char name[MSG_MAX_NAME + 1];
    struct coord_worker *worker; /* of that name */
    enum part_state state;       /* by part_step() alone */
    uint32_t threads;
    bool took_part;    /* it was READY once */
    bool late;         /* others do its work until it is heard of */
    uint64_t ready_ms; /* first READY */
    double load_s;
    uint64_t fingerprint;

    /* what it has (hold.c) */
    uint32_t in_flight; /* units of this job that it works on */
    uint32_t held;      /* threads, as counted for the job's owner */
    uint32_t lines;     /* of these units */
    uint32_t parked;    /* units that wait for something */
    uint32_t given;     /* units that it began apart (sched.c) */

    /* speed.c */
    uint64_t since_ms; /* work_ms is counted until then */
    uint64_t work_ms;  /* time with something in flight */
    double speed;      /* of all its threads, relative to the others' */

    /* before the units */
    uint32_t surveying;     /* chunk of areas that it estimates, from 1; 0: none
                             */
    uint64_t surveyed_rays; /* of areas, and of tiles */
    uint32_t passes; /* that it knows to be closed: it has their records, or
                      * says that it lacks some (records.c) */
    uint32_t lacked; /* of passes before this one it has been sent all records
                      * that it lacked */
    uint32_t ntiles[MSG_OPEN_PASSES]; /* that it makes, by the pass's number */
    bool lags;       /* nothing more goes to it before it says that it has the
                      * records of the next pass */
    bool shows;      /* it was told with which options pictures are made */
    uint32_t feeder; /* index + 1 of the worker that sends it records of tiles;
                      * 0: the coordinator does (feeding.c) */
    bool missed;     /* records of tiles that its feeder should have sent */
    uint32_t failures; /* times that it fed a worker which then missed some */
    uint32_t excused;  /* passes to be closed until records that it misses are a
                        * failure of its feeder */
    uint64_t rest_ms;  /* told to leave its areas then (REST), and given
                        * nothing since; 0: it was not */

    /* loss.c */
    uint32_t load_crashes; /* children that died before READY */
    uint32_t setbacks; /* children lost for reasons of its own, since it last
                        * finished a unit */
    uint64_t keep_ms;  /* until then units that it lost wait for it; 0: none
                        * do */

    /* yield.c */
    uint8_t passed;  /* how often it had room, and the job nothing for it of the
                      * units that waited */
    uint64_t ask_ms; /* the job is not asked again before that */

    /* what it did */
    uint32_t units; /* accepted */
    uint64_t rays;  /* of these */
    double cpu_s;
    struct msg_tally tally; /* of its present child; job is not kept */
    struct msg_tally past;  /* summed over earlier children */
    struct msg_counts paid; /* by PAIDs of its present child, and what was to
                             * come in others but did not */
    bool tallied;           /* in this life of the coordinator */
};

/* Which state may follow which; see the head of part.c. */
extern const struct steps part_steps;
/* Change the state of a worker's part; the step must be in part_steps. */
void part_step(struct job_worker *jw, enum part_state to);

/* Is it loading the job or ready? */
bool part_is_here(const struct job_worker *jw);

/* The worker of that name, JOB_NOBODY if it never was one; part_add makes it
 * one (JOB_NOBODY when memory is out). */
uint32_t part_find(const struct job *job, const char *name);
uint32_t part_add(struct job *job, const char *name);

/* Sum of a worker's tallies, but for rays_under_way and pixels_under_way, which
 * are 0. */
struct msg_tally part_tally(const struct job_worker *jw);
/* All rays that it traced for the job, in units that are done or in none. */
uint64_t part_rays(const struct job_worker *jw);
/* And in those that it has in hand. */
uint64_t part_under_way(const struct job_worker *jw);

#endif
