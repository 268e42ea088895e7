/* msg_job.h - the messages about a job as a whole
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_JOB_H
#define MSG_JOB_H

#include "proto/msg_store.h"

struct msg_frame {
    uint32_t number;        /* 0 for a still, the view's number in an
                             * animation */
    uint32_t width, height; /* pixels that are rendered */
    const char *view;       /* rpict's view options */
};

#define MSG_FRAME_BYTES 15 /* on the wire, but for the view's text */

/* SUBMIT, JOB-START: what a job is, the same for the coordinator, a worker and
 * a child. */
#define MSG_SPEC_ADDED 12 /* bytes of origin, oversample and clamp, if none */
struct msg_spec {
    const uint8_t *job;      /* id, MSG_JOB bytes, made by radsubmit */
    const uint8_t *manifest; /* hash of the bundle's manifest */
    const char *name;
    const char *params;   /* rad_params_format() */
    const char *origin;   /* header lines of its pictures that say where they
                           * are from, each with its newline; or "" */
    const char *needs;    /* features the scene uses, blanks between */
    const char *estimate; /* --estimate, "uniform" by default */
    uint32_t ncosts;      /* 0: none, or the base lines of all frames */
    const uint8_t *costs; /* of each line of each frame, in any unit: as many
                           * floats on the wire (wire_floats_get), none below
                           * 0 */
    uint64_t seed;
    int32_t priority;
    uint32_t flags;    /* MSG_JOB_... */
    uint8_t partition; /* enum msg_partition */
    uint8_t order;     /* enum msg_order */
    uint32_t windows;  /* 0: by the picture's size */
    uint32_t objects;  /* in the scene, for the statistics */
    uint64_t bundle_bytes;
    double compile_s;
    uint32_t memory_mib; /* most memory of its process on a worker; 0: as much
                          * as that has for it */
    uint8_t oversample; /* samples a side of each pixel of the picture that is
                         * written, which is filtered down from what is
                         * rendered (image/filter.h); 0 or 1: none */
    double clamp;       /* most weight of a sample, times that of those about
                         * it; 0: any.  Else oversample is 2 at least */
    struct msg_hashes files; /* all of the bundle, the manifest among them */
    uint32_t nframes;
    const struct msg_frame *frames; /* NULL: they are in a file, not yet read */
    /* with MSG_JOB_VIEWS: */
    const uint8_t *views;   /* hash of that file, one of `files` */
    uint32_t width, height; /* the largest of any frame [pixels] */
};

/* The job is in the queue, whole. */
struct msg_accept {
    const uint8_t *job;
    uint8_t again; /* it was there already: attached to it */
};

/* Pixels that were no numbers, or infinite or negative, and are black. */
struct msg_nan {
    uint64_t pixels;
    uint32_t frame, x, y; /* the first of them, by frame, y, x; 0 when there
                           * are none */
};

/* Functions that failed to give a value: of which objects of the scene, and how
 * often.  The first few by number; a count of 0 ends them. */
#define MSG_FAULTS 4
struct msg_fault {
    uint32_t object;
    uint64_t count;
};

/* of those that a PROGRESS has: what others than the coordinator act on */
#define MSG_STATE_WAITING   0
#define MSG_STATE_RUNNING   1
#define MSG_STATE_PAUSED    2
#define MSG_STATE_FAILED    4
#define MSG_STATE_CANCELLED 5
#define MSG_STATE_HELD      6

struct msg_progress {
    const uint8_t *job; /* zero: of one that is not accepted yet */
    uint8_t state;      /* enum job_state of daemon/desk/job.h: 0 waiting,
                         * 1 running, 2 paused, 3 done, 4 failed,
                         * 5 cancelled; or MSG_STATE_HELD: the coordinator has
                         * no room on its disk */
    uint64_t pixels_done, pixels_total;
    uint32_t units_done, units_total, units_redone;
    double cost_done, cost_total; /* estimated; same unit for both; of units
                                   * under way by the pixels they are past */
    uint64_t rays;
    uint32_t workers;      /* that work on the job now */
    uint32_t frames_ready; /* the first so many frames can be fetched */
    double elapsed_s;      /* since the job was accepted */
    struct msg_nan nan;    /* in the units that are done; frame as named */
    struct msg_fault faults[MSG_FAULTS]; /* in them, too */
    double error; /* relative, as estimated of them; 0: nothing is known */
};

struct msg_done {
    const uint8_t *job;
    uint32_t frames;
};

/* A job, or the request that this answers, failed; the job's id is zero when
 * it is about none. */
struct msg_failed {
    const uint8_t *job;
    uint16_t status;
    const char *text;
};

#endif
