/* msg_order.h - requests of radsubmit and radctl to the coordinator
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_ORDER_H
#define MSG_ORDER_H

#include "proto/msg_basics.h"

/* CANCEL, PAUSE, RESUME, DELETE, JOB-END. */
struct msg_jobid {
    const uint8_t *job;
};

#define MSG_MOST_PRIORITY 100 /* of a job; the least is -100 */
struct msg_priority {
    const uint8_t *job;
    int32_t priority; /* higher goes first */
};

struct msg_fetch {
    const uint8_t *job;
    uint32_t frame; /* index, from 0 */
    uint8_t what;   /* enum msg_what */
};

struct msg_query {
    uint8_t what; /* enum msg_topic */
    const char *text;
};

/* The lists that PAGE asks for. */
enum msg_rows { MSG_ROWS_JOBS, MSG_ROWS_WORKERS, MSG_NROWS };

/* Ask for some rows of a list of any length.  The answer has as many rows as
 * the coordinator sends at once, and the cursor of the next ones, which stays
 * valid while rows come and go. */
struct msg_page {
    uint8_t what;      /* enum msg_rows */
    uint8_t mine;      /* 1: only jobs of the user that asks */
    const char *user;  /* only jobs of that owner; empty: of any */
    const char *state; /* only rows in that state, or jobs that are "open" (not
                        * over) or "over"; empty: in any */
    uint64_t cursor;   /* from the last answer; 0: from the start */
    uint32_t most;     /* most rows in the answer; 0: no limit */
};

/* JSON, not terminated.  Empty as the answer to CANCEL and the like. */
struct msg_answer {
    const uint8_t *text;
    size_t len;
};

/* What KEY asks for. */
enum msg_key_order { MSG_KEY_ADD, MSG_KEY_RETIRE, MSG_KEY_LIST, MSG_NKEY };

/* An order about the coordinator's keys (keyfile.h); the answer is JSON. */
struct msg_key {
    uint8_t what;     /* enum msg_key_order */
    const char *name; /* "worker:ws07", "worker:ws07:k1"; empty for LIST */
    uint64_t expires; /* of a new key, seconds since 1970; 0: never */
};

/* UNDRAIN, FORGET: a worker's name. */
struct msg_worker {
    const char *name;
};

/* Why a worker is to get no more work. */
enum msg_drain_why {
    MSG_DRAIN_ORDER,   /* an admin's; all others are the worker's own */
    MSG_DRAIN_STOPPED, /* its radd ends */
    MSG_DRAIN_HOURS,   /* `hours` of radd.conf are over */
    MSG_DRAIN_IN_USE,  /* `idle_only` there, and somebody uses the machine */
    MSG_NDRAIN
};

struct msg_drain {
    const char *name;
    uint8_t why; /* enum msg_drain_why */
};

#endif
