/* part.h - a worker's part in a job
 *
 * A worker keeps its index in job.workers until the job is forgotten, also when
 * it is gone, so that its work stays counted.  The states are drawn at the head
 * of part.c.
 * Thread: the coordinator's loop. */
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
    PART_GONE,     /* not connected, or not told of the job */
    PART_NO_ROOM,  /* its disk has no room for the job's files: not started
                    * again before it says that there is (ROOM) */
    PART_EXCLUDED, /* not started again: it computes other bits (--same-bits),
                    * or its children died too often */
    PART_LOADING,  /* JOB_START was sent */
    PART_READY
};
#define PART_STATES 5

struct job_worker {
    char name[MSG_MAX_NAME + 1];
    struct coord_worker *worker; /* the worker of this name */
    enum part_state state;       /* changed by part_step() alone */
    uint32_t threads;
    bool took_part;    /* it was READY once */
    bool late;         /* other workers do its work until it is heard of */
    uint64_t ready_ms; /* when it was first READY */
    double load_s;
    uint64_t fingerprint;

    /* attempts that it has (attempt.c) */
    uint32_t in_flight; /* attempts that are GO_WORKING */
    uint32_t counted_threads; /* its threads, as counted for the job's payer */
    uint32_t lines;     /* lines of the attempts in flight */
    uint32_t parked;    /* attempts that wait (go_waits()) */
    uint32_t given;     /* units that went to it apart from one another, at
                         * first (handout.c) */

    /* speed.c */
    uint64_t since_ms; /* work_ms is counted up to then */
    uint64_t work_ms;  /* time in which it had something in flight */
    double speed;      /* of all its threads; a thread of mean speed has 1 */

    /* before the units */
    uint32_t surveying; /* chunk of areas that it estimates, from 1; 0: none */
    uint64_t surveyed_rays; /* rays of its areas and tiles */
    uint32_t passes; /* closed passes that it was told of: it has their records,
                      * or says that it lacks some (records.c) */
    uint32_t lacked; /* of passes before this one it was sent all records that
                      * it lacked */
    uint32_t ntiles[MSG_OPEN_PASSES]; /* tiles that it makes, by pass number
                                       * modulo MSG_OPEN_PASSES */
    bool lags;       /* it gets nothing more before it says that it has the
                      * records of the next pass */
    bool shows;      /* it was told the options of the pictures (SHOW) */
    uint32_t feeder; /* index + 1 of the worker that sends it records of tiles;
                      * 0: the coordinator does (feeding.c) */
    bool missed;     /* it lacked records that its feeder should have sent */
    uint32_t failures; /* how often a worker that it fed lacked records */
    uint32_t excused;  /* until this many more passes are closed, its feeder is
                        * not to blame for records that it lacks */
    uint64_t rest_ms;  /* when it was told to leave its areas (REST); 0: never,
                        * or it got work since */

    /* loss.c */
    uint32_t load_crashes; /* children that died before READY */
    uint32_t setbacks; /* children that it lost for reasons of its own since it
                        * last finished a unit */
    uint64_t keep_ms;  /* until when units that it lost are kept for it; 0: none
                        * are */

    /* yield.c */
    uint8_t passed;  /* how often in a row it had room, and none of the job's
                      * waiting units was for it; bounded */
    uint64_t ask_ms; /* until then, waiting units of the job are taken to be
                      * none for it */

    /* what it did */
    uint32_t units;         /* units that were accepted from it */
    uint64_t rays;          /* of these units */
    double cpu_s;           /* of these units */
    struct msg_tally tally; /* of its present child; tally.job is not kept */
    struct msg_tally past;  /* sum over its earlier children */
    struct msg_counts paid; /* counts in its present child's PAID messages, and
                             * those that other messages owed and did not have
                             */
    bool tallied;           /* a TALLY came in this life of the coordinator */
};

/* Which state may follow which; see the head of part.c. */
extern const struct steps part_steps;
/* Change the state of a worker's part; the step must be in part_steps. */
void part_step(struct job_worker *jw, enum part_state to);

/* Is it loading the job or ready? */
bool part_is_here(const struct job_worker *jw);

/* The index of the worker of that name; JOB_NOBODY: it has no part in the job.
 * part_add() adds it if need be; JOB_NOBODY: memory is out. */
uint32_t part_find(const struct job *job, const char *name);
uint32_t part_add(struct job *job, const char *name);

/* Sum of a worker's tallies; rays_under_way and pixels_under_way are 0. */
struct msg_tally part_tally(const struct job_worker *jw);
/* All rays that it traced for the job but those under way. */
uint64_t part_rays(const struct job_worker *jw);
/* Rays of units that it has in hand. */
uint64_t part_under_way(const struct job_worker *jw);

#endif
