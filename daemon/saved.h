/* saved.h - what a store remembers of a job, and gives back after a restart
 *
 * Plain data between the scheduler, which says what is to be kept and takes it
 * up again (recover.h), and the store, which keeps it (journal.h).  What
 * pointers lead to is the giver's.
 * Times are those of the coordinator's clock, see coord.h.
 * Thread: any. */
#ifndef DAEMON_SAVED_H
#define DAEMON_SAVED_H

#include "partition.h"

/* A unit that went out: its latest attempt, and what is kept of its rows. */
struct saved_unit {
    uint32_t unit;
    struct partition_area area;
    uint32_t attempt;     /* whose rows count */
    uint32_t tries;       /* how often it went out */
    const char *worker;   /* of that attempt; "": it never went out */
    uint64_t fingerprint; /* of that worker */
    uint32_t stored;      /* rows of it that are kept, from its top */
    uint64_t sum;         /* rowsum() of these; put: of those that came now, */
    uint32_t now;         /* so many */
    bool done;            /* all of them; then the rest is known */
    uint64_t end_ms;
    struct msg_counts counts;
    const uint8_t *bottom; /* densities of its last base line */
    uint32_t nbottom;      /* 0: a window, or the last of its frame */
};

struct saved_job {
    struct msg_spec spec;
    const char *owner;
    uint32_t lives; /* of the coordinator since it was submitted, before this */
    uint8_t state;  /* enum job_state: paused, over, or any other */
    int status;     /* of one that is over */
    const char *text;
    uint64_t offer_ms, submit_ms, open_ms, end_ms, sent_bytes;
    uint64_t kept_bytes;      /* of one that is over: what its folder holds */
    struct msg_progress last; /* of one that is over */
    const bool *written;      /* by frame: its picture is there */
    uint32_t nunits;          /* of one that is not over */
    const struct saved_unit *units; /* by number */
};

#endif
