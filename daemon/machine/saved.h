/* saved.h - what a store keeps of a job, and gives back after a restart
 *
 * Plain data.  The scheduler says what is to be kept, and takes it up after a
 * restart (recover.h); the store keeps it (journal.h).  Pointers lead to memory
 * of the side that filled the struct.
 * Times are those of the coordinator's clock, see coord.h.
 * Thread: any. */
#ifndef DAEMON_SAVED_H
#define DAEMON_SAVED_H

#include "ground/mark.h"
#include "partition/partition.h"

/* A unit that went out: its latest attempt, and what is kept of its rows. */
struct saved_unit {
    uint32_t unit;
    struct partition_area area;
    uint32_t attempt;     /* the latest attempt, whose rows count */
    uint32_t tries;       /* how often the unit went out */
    const char *worker;   /* of that attempt; "": the unit never went out */
    uint64_t fingerprint; /* of that worker */
    uint32_t stored;      /* the unit's rows that are kept, from its top */
    uint64_t sum;         /* rowsum() of these; when put: of the new rows */
    uint32_t now;         /* when put: how many of these are new */
    bool done;            /* all rows are kept; then the fields below are set */
    uint64_t end_ms;      /* a date */
    struct msg_counts counts;
    const uint8_t *bottom; /* densities of its last base line */
    uint32_t nbottom;      /* 0: no line is kept, or the line has none, for
                            * each pixel is traced */
};

/* A frame of a job. */
struct saved_frame {
    bool written;               /* the frame's picture is there */
    bool fetched;               /* the job's owner has the picture */
    struct mark picture, depth; /* with written; depth: of a job with it */
};

/* The records of a pass of the ambient cache. */
struct saved_pass {
    const uint8_t *bytes;
    size_t len;
    struct msg_counts counts; /* of its tiles */
    bool firm; /* sync the pass before anything later is kept; not kept */
};

/* The records of another job's cache that a job begins with, as they were read.
 */
struct saved_cache {
    uint8_t *records; /* malloc'd, the receiver's; NULL: reading failed */
    size_t len;
    int status; /* 0, or of sysexits.h, with text */
    const char *text;
};

/* The most bytes of records of one stage of a job. */
#define SAVED_STAGE_BYTES (UINT64_C(512) << 20)

/* Passes [first, end), which have the records of a job's last stage, of `all`
 * its passes. */
struct pass_range {
    uint32_t first, end, all;
};

struct saved_job {
    struct msg_spec spec;
    const char *owner;
    uint64_t sequence; /* of the job in this life; not kept */
    uint32_t lives; /* of the coordinator since the job came, but this life */
    uint8_t state;  /* enum job_state: paused, over, or any other */
    int status;     /* of a job that is over */
    const char *text;
    uint64_t offer_ms, submit_ms, open_ms, end_ms; /* dates (desk.h) */
    uint64_t sent_bytes;
    uint64_t kept_bytes;      /* of a job that is over: bytes of its folder, */
    uint64_t cache_bytes;     /* and of these its ambient cache's; when put: not
                               * 0 if the cache is to be kept */
    struct msg_progress last; /* of a job that is over */
    struct mark stats;        /* of a job that is over */
    bool given_up; /* the job was cancelled on a full disk, where its end could
                    * not be kept: its rows are gone */
    const struct saved_frame *frames; /* by index */
    uint32_t nunits;                  /* of a job that is not over */
    const struct saved_unit *units;   /* by number */
    uint32_t npasses;       /* closed passes of a job that is not over; if it
                             * began with another job's cache the first pass
                             * has no bytes here */
    struct pass_range keep; /* of a job whose cache is to be kept */
    const struct saved_pass *passes; /* by number */
};

/* Why a job that was over is forgotten. */
enum gone_why {
    GONE_MANY,    /* its owner has more such jobs than are kept */
    GONE_OLD,     /* it was over for longer than is kept */
    GONE_LARGE,   /* its owner's jobs took more room than they may */
    GONE_BEFORE,  /* radcoord ended as the job was being forgotten */
    GONE_DELETED, /* a user deleted it */
    GONE_NWHYS
};

/* A job that was forgotten, and why; kept for a while. */
#define SAVED_GONES 100 /* of each owner, the last so many */
struct saved_gone {
    uint8_t job[MSG_JOB];
    char owner[MSG_MAX_NAME + 1];
    char name[MSG_MAX_NAME + 1]; /* or as much of it as fits */
    enum gone_why why;
    bool fetched; /* its owner had all of its pictures */
    uint64_t end_ms, gone_ms;
    uint64_t sequence; /* in this life: the job's place in a list of jobs */
};

#endif
