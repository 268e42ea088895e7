/* msg_order.h - what radsubmit and radctl ask the coordinator for
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_ORDER_H
#define MSG_ORDER_H

#include "proto/msg_basics.h"

/* CANCEL, PAUSE, RESUME, DELETE, JOB-END. */
struct msg_jobid {
    const uint8_t *job;
};

#define MSG_MOST_PRIORITY 100 /* and least, below 0, that a job may have */
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

/* Which list PAGE asks for a part of. */
enum msg_rows { MSG_ROWS_JOBS, MSG_ROWS_WORKERS, MSG_NROWS };

/* Some rows of a list of any length.  The answer has as many as are good to
 * send at once, and the cursor for the rows behind them, which holds good
 * whatever comes and goes meanwhile. */
struct msg_page {
    uint8_t what;      /* enum msg_rows */
    uint8_t mine;      /* 1: of jobs the asker's own alone */
    const char *user;  /* of jobs those of that owner; empty: of any */
    const char *state; /* those in that state, or jobs that are "open" (not
                        * over) or "over"; empty: in any */
    uint64_t cursor;   /* from the answer before; 0: from the start */
    uint32_t most;     /* rows; 0: no limit */
};

/* JSON; not terminated.  Empty as the answer to CANCEL and the like. */
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

/* DRAIN, UNDRAIN, FORGET: a worker's name. */
struct msg_worker {
    const char *name;
};

#endif
