/* msg_work.h - the messages by which units go out and rows come back
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_WORK_H
#define MSG_WORK_H

#include "proto/msg_job.h"

struct msg_ready {
    const uint8_t *job;
    double load_s;
    uint64_t fingerprint;
    uint16_t threads;
    uint32_t passes; /* closed passes whose records the child has (FROZEN) */
};

/* Errors that were found by making pixels again: sums of src/picture/doubt.h,
 * each between -1e100 and 1e100. */
#define MSG_DOUBT_SUMS 7
struct msg_doubt {
    double v[MSG_DOUBT_SUMS];
};

/* The cost of one unit; nan.frame is the unit's frame and is not sent. */
struct msg_counts {
    uint64_t rays, primary_rays, speculative_rays, shadow_rays, ambient_rays,
        paint_rays, estimate_rays, intersection_tests, ambient_values;
    struct msg_nan nan;
    struct msg_fault faults[MSG_FAULTS];
    double cpu_s;  /* processor time of the render threads */
    double wall_s; /* from taking the unit to its last row; for a strict unit
                    * the time of its passes (daemon/strict/strict.h) */
    struct msg_doubt doubt;
};

/* Rows of a unit, from its top; each piece follows the one before.  Pixels are
 * r g b, or r g b distance with channels 4, as floats on the wire
 * (wire_floats_get).  With channels 1, in jobs with MSG_JOB_CODED, rows are
 * coded as in a picture file (rad_hdr_encode_row()); unpacking does not check
 * those.  Only the last piece has counts. */
struct msg_result {
    const uint8_t *job;
    uint32_t unit, attempt;
    uint32_t row, rows, width; /* row from the unit's top */
    uint8_t channels;          /* 3 or 4; 1: coded */
    uint8_t last;
    struct msg_counts counts;
    const uint8_t *pixels; /* rows * width * channels floats, or coded rows */
    size_t len;            /* bytes of coded rows; not used for floats */
};

struct msg_ack {
    const uint8_t *job;
    uint32_t unit, attempt, row, rows;
};

/* REVOKE, PARKED, RESUMED, SPLIT, YIELD: a worker's attempt at a unit. */
struct msg_attempt {
    const uint8_t *job;
    uint32_t unit, attempt;
};

/* The job's child ended by itself.  units: those it was working on, which may
 * have caused that. */
struct msg_lost {
    const uint8_t *job;
    uint16_t status;  /* of sysexits.h: EX_SOFTWARE: it crashed or hung;
                       * EX_OSERR, EX_IOERR: it lacked memory, a file */
    const char *text; /* "killed by signal 11" */
    uint32_t nunits;
    const uint32_t *units;
};

/* Has the worker room for the files of a job that it was told to begin? */
struct msg_room {
    const uint8_t *job;
    uint8_t has;      /* 1: yes, the job may begin there; 0: not now */
    const char *text; /* why not */
};

/* The sum of a worker's work for a job so far; it replaces the TALLY before. */
struct msg_tally {
    const uint8_t *job;
    uint64_t ambient_sent, ambient_received, ambient_redundant;
    uint64_t cache_values; /* ambient records that its child holds now */
    uint64_t peak_rss_bytes, bytes_in, bytes_out;
    uint64_t base_line_bytes;  /* sent in BASE_LINEs, to peers and up */
    uint64_t base_line_pixels; /* of the base lines at the ends of its units */
    /* seconds, summed over render threads */
    double busy_s;           /* on units, including waits */
    double wait_base_line_s; /* part of busy_s: waits for the line above */
    uint64_t rays_under_way; /* of units that are not done */
    /* of strict units and loans that were taken back, such as those of a twin
     * that was second: their work is in no RESULT and no PAID.  Without primary
     * rays, nan and faults; speculative rays are facts that were not sent. */
    struct msg_counts dropped;
    /* the sum of all PAIDs that this child sent.  If a connection broke some
     * did not arrive; the coordinator counts the difference as dropped */
    struct msg_counts paid;
    uint64_t pixels_under_way; /* of strict units under way: pixels in rows that
                                * are not sent yet, which passes are past */
};

#endif
