/* part.h - a worker's part in a job
 *
 * A part keeps its index in job.parts until the job is forgotten, also when its
 * worker is gone, so that what the worker did stays counted.  The states are
 * drawn at the head of part.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PART_H
#define DAEMON_PART_H

#include "proto/message.h"

#include <stdbool.h>
#include <stdint.h>

struct coord_worker;
struct job;
struct steps;

#define JOB_NOBODY UINT32_MAX /* in place of an index: no part */

enum part_state {
    PART_GONE,     /* not connected, or not told of the job */
    PART_NO_ROOM,  /* the worker's disk has no room for the job's files: no
                    * JOB_START before ROOM says that there is room */
    PART_EXCLUDED, /* no JOB_START any more: the worker computes other bits
                    * (--same-bits), or its children died too often */
    PART_LOADING,  /* JOB_START was sent */
    PART_READY     /* READY came: the worker's child has loaded the job */
};
#define PART_STATES 5

struct job_part {
    char name[MSG_MAX_NAME + 1];
    struct coord_worker *worker; /* the worker of this name */
    enum part_state state;       /* changed by part_step() alone */
    uint32_t threads;
    bool took_part;    /* the worker was READY once */
    bool late;         /* the worker gets no work of the job, and others do its
                        * units, until it is heard of */
    uint64_t ready_ms; /* when the worker was first READY */
    double load_s;     /* time that its child took to load the job */
    uint64_t fingerprint;

    /* the worker's attempts (holding.c) */
    uint32_t in_flight;       /* attempts that are ATTEMPT_WORKING */
    uint32_t counted_threads; /* its threads, as counted for the job's payer */
    uint32_t parked;          /* attempts that wait (attempt_waits()) */

    /* speed.c */
    uint64_t since_ms; /* work_ms is counted up to then */
    uint64_t work_ms;  /* time in which the worker had attempts in flight */
    double speed;      /* of all its threads; a thread of mean speed has 1 */

    /* before the units */
    uint32_t surveying;     /* chunk of areas that the worker estimates, counted
                             * from 1; 0: none */
    uint64_t surveyed_rays; /* rays of the worker's areas and tiles */
    uint32_t passes; /* closed passes that the worker was told of: it has their
                      * records, or says that it lacks some (records.c) */
    uint32_t lacked; /* the worker was sent all records that it lacked of passes
                      * before this number */
    uint32_t ntiles[MSG_OPEN_PASSES]; /* tiles that the worker makes, by pass
                                       * number modulo MSG_OPEN_PASSES */
    bool lags;       /* the worker gets nothing more before it says that it has
                      * the records of the next pass */
    bool shows;      /* the options of the pictures were sent (SHOW) */
    uint32_t feeder; /* index + 1 of the worker that sends this worker records
                      * of tiles; 0: the coordinator does (feeding.c) */
    bool missed;     /* the worker lacked records when a pass was closed */
    uint32_t failures; /* how often a worker that this worker fed lacked records
                        */
    uint32_t excused;  /* until this many more passes are closed the worker's
                        * feeder is not to blame for records that lack */

    /* loss.c */
    uint32_t load_crashes; /* children that died before READY */
    uint32_t setbacks; /* children that the worker lost for reasons of its own
                        * since it last finished a unit or a tile */
    uint64_t keep_ms;  /* until when units that the worker lost are kept for it;
                        * 0: none are */

    /* sched.c */
    uint8_t passed;  /* how often in a row the worker had room, and no waiting
                      * unit of the job was for it; bounded */
    uint64_t ask_ms; /* until then no waiting unit of the job is taken to be
                      * for the worker (yield.c) */

    /* work done */
    uint32_t units;         /* units that the worker finished */
    uint64_t rays;          /* of these units */
    double cpu_s;           /* of these units */
    struct msg_tally tally; /* of its present child; tally.job is not kept */
    struct msg_tally past;  /* sum over its earlier children */
    struct msg_counts paid; /* counts of its present child's loans: from PAID
                             * messages, and from TALLYs that show a PAID which
                             * did not come */
    bool tallied;           /* a TALLY came in this life of the coordinator */
};

/* Which state may follow which; see the head of part.c. */
extern const struct steps part_steps;
/* Change the state of a worker's part; the step must be in part_steps. */
void part_step(struct job_part *part, enum part_state to);

/* The first part whose worker was READY, in any life; NULL: none was. */
const struct job_part *part_first(const struct job *job);

/* Does the worker load the job, or is it ready? */
bool part_is_here(const struct job_part *part);

/* The index of the part of the worker of this name; JOB_NOBODY: it has none.
 * part_add() gives it a part if it has none; JOB_NOBODY: memory is out. */
uint32_t part_find(const struct job *job, const char *name);
uint32_t part_add(struct job *job, const char *name);

/* Sum of a worker's tallies; rays_under_way and pixels_under_way are 0. */
struct msg_tally part_tally(const struct job_part *part);
/* All rays that the worker traced for the job but those under way. */
uint64_t part_rays(const struct job_part *part);
/* Rays under way: traced of units that are not done; 0 if it is not ready. */
uint64_t part_under_way(const struct job_part *part);

#endif
