/* worker.h - a worker that is, or was, connected to the coordinator
 *
 * desk_takes_units() says whether it may get work.  Its part in a job is a
 * struct job_part (jobs/part.h).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DESK_WORKER_H
#define DAEMON_DESK_WORKER_H

#include "proto/message.h"

struct job;

struct coord_worker {
    struct coord_worker *next;
    char name[MSG_MAX_NAME + 1];
    char program[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1]; /* where peers dial the worker */
    uint64_t conn;                     /* 0: not connected */
    uint32_t threads;
    unsigned version; /* of the protocol on its connection */
    uint64_t fingerprint;
    uint64_t since_ms;    /* when it was connected, or its connection ended */
    uint32_t id;          /* from 0, in the order of the workers' first HELLO */
    uint32_t in_flight;   /* attempts of all jobs that are ATTEMPT_WORKING */
    uint32_t parked;      /* attempts that wait (attempt_waits()) */
    uint32_t delivered;   /* attempts that are ATTEMPT_DELIVERED */
    double relative;      /* speed of a thread in earlier jobs; 1: the mean */
    uint64_t free_ms;     /* when in_flight last became 0 */
    struct job *fills;    /* job whose tiles it makes or areas it estimates */
    int64_t priority;     /* highest of its jobs in flight; INT64_MIN: none */
    int64_t rank;         /* highest of these jobs, or with units for it */
    uint32_t load;        /* of its host, in hundredths, by its last PING */
    uint64_t progress;    /* progress counter of the last PING */
    uint64_t progressed_ms; /* when that counter last changed */
    bool hangs;           /* has work, but its progress counter stands still */
    const struct job *loading; /* job that its next READY is for */
    bool forgotten;            /* gone, and no longer listed */
    bool expelled;             /* its key ended, and it has not come since */
    bool drained;              /* gets no new work: an admin's wish */
    uint8_t leaving;   /* gets no new work: its own wish, for this reason
                        * (enum msg_drain_why); 0: it does not leave */
    bool alone;        /* has a suspect unit, and gets no other unit now */
    char no_room[256]; /* why its disk last had no room for a job's files */
};

#endif
