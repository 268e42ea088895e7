/* saved.h - what a store remembers of a job, and gives back after a restart
 *
 * Plain data between the scheduler, which says what is to be kept and takes it
 * up again (recover.h), and the store, which keeps it (journal.h).  What
 * pointers lead to is the giver's.
 * Times are those of the coordinator's clock, see coord.h.
 * Thread: any. */
#ifndef DAEMON_SAVED_H
#define DAEMON_SAVED_H

#include "ground/mark.h"
#include "partition/partition.h"
#include "refine/refine.h"

/* A unit that went out: its latest attempt, and what is kept of its rows. */
struct saved_unit {
    uint32_t unit;
    struct partition_area area;
    uint32_t attempt;     /* whose rows count */
    uint32_t tries;       /* how often it went out */
    const char *worker;   /* of that attempt; "": it never went out */
    uint64_t fingerprint; /* of that worker */
    uint32_t stored;      /* rows of it that are kept, from its top */
    uint64_t sum;         /* rowsum() of these; when put: of the new ones */
    uint32_t now;         /* when put: how many of these are new */
    bool done;            /* all rows are kept; then the rest is known */
    uint64_t end_ms;
    struct msg_counts counts;
    const uint8_t *bottom; /* densities of its last base line */
    uint32_t nbottom;      /* 0: a window, or the last of its frame */
};

/* A frame of a job. */
struct saved_frame {
    bool written;               /* its picture is there */
    bool fetched;               /* and its owner has it */
    struct mark picture, depth; /* with written; depth: of what has distances */
};

/* The records of a pass of the ambient cache. */
struct saved_pass {
    const uint8_t *bytes;
    size_t len;
    struct msg_counts counts; /* of its tiles */
    bool firm; /* to be on the disk before what comes later; not kept */
};

/* Records of the passes of one stage of a job, in bytes, and what its stages
 * may come to together. */
#define SAVED_STAGE_BYTES (UINT64_C(512) << 20)
#define SAVED_MOST_BYTES  (RAD_REFINE_STAGES * SAVED_STAGE_BYTES)

/* Of all passes of a job those with the records of its last stage. */
struct pass_range {
    uint32_t first, end, all;
};

struct saved_job {
    struct msg_spec spec;
    const char *owner;
    uint64_t sequence; /* of the job in this life; not kept */
    uint32_t lives; /* of the coordinator since it was submitted, before this */
    uint8_t state;  /* enum job_state: paused, over, or any other */
    int status;     /* of one that is over */
    const char *text;
    uint64_t offer_ms, submit_ms, open_ms, end_ms, sent_bytes;
    uint64_t kept_bytes;      /* of one that is over: what its folder holds, */
    uint64_t cache_bytes;     /* and of that its ambient cache; to be kept: not
                               * 0 */
    struct msg_progress last; /* of one that is over */
    struct mark stats;        /* of one that is over */
    const struct saved_frame *frames; /* by index */
    uint32_t nunits;                  /* of one that is not over */
    const struct saved_unit *units;   /* by number */
    uint32_t npasses;       /* of one that is not over: closed ones; the
                             * first of a job that began with another's
                             * cache without its bytes */
    struct pass_range keep; /* of one whose cache is to be kept */
    const struct saved_pass *passes; /* by number */
};

/* Why a job that was over is forgotten. */
enum gone_why {
    GONE_MANY,    /* its owner has more such jobs than are kept */
    GONE_OLD,     /* it was over for longer than is kept */
    GONE_LARGE,   /* its owner's took more room than they may */
    GONE_BEFORE,  /* radcoord ended as it was being forgotten */
    GONE_DELETED, /* somebody said so */
    GONE_NWHYS
};

/* What is remembered of a job that was forgotten, for a while. */
#define SAVED_GONES 100 /* of each owner, the last so many */
struct saved_gone {
    uint8_t job[MSG_JOB];
    char owner[MSG_MAX_NAME + 1];
    char name[MSG_MAX_NAME + 1]; /* or as much of it as fits */
    enum gone_why why;
    bool fetched; /* its owner had all of its pictures */
    uint64_t end_ms, gone_ms;
    uint64_t sequence; /* in this life: its place in a list of jobs */
};

#endif
