/* msg_job.h - the messages about a job as a whole
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_JOB_H
#define MSG_JOB_H

#include "proto/msg_store.h"

struct msg_frame {
    uint32_t number;        /* 0: a still; else the view's number in an
                             * animation */
    uint32_t width, height; /* pixels that are rendered */
    const char *view;       /* rpict's view options */
};

#define MSG_FRAME_BYTES 15 /* bytes on the wire, with an empty view */

struct msg_spec {
    const uint8_t *job;      /* id, MSG_JOB bytes, made by radsubmit */
    const uint8_t *manifest; /* hash of the bundle's manifest */
    const char *name;
    const char *params;   /* rad_params_format() */
    const char *origin;   /* lines of the pictures' headers that say where they
                           * are from, each with its newline; or "" */
    const char *needs;    /* features the scene uses, blanks between */
    const char *estimate; /* --estimate, "uniform" by default */
    uint32_t ncosts;      /* lines of all frames; 0: no costs are given */
    const uint8_t *costs; /* of each line of each frame, in any unit: ncosts
                           * floats on the wire (wire_floats_get), none below 0
                           */
    uint64_t seed;
    int32_t priority;
    uint32_t flags;    /* MSG_JOB_... */
    uint8_t partition; /* enum msg_partition */
    uint8_t order;     /* enum msg_order */
    uint32_t windows;  /* 0: by the picture's size */
    uint32_t objects;  /* in the scene, for the statistics */
    uint64_t bundle_bytes;
    double compile_s;
    uint32_t memory_mib; /* most memory of the job's child; 0: as much as the
                          * worker has for it */
    uint8_t oversample;  /* rendered pixels a side of each pixel of the picture,
                          * which is filtered down (image/filter.h); 0 or 1: not
                          * filtered */
    double clamp;       /* most weight of a sample, relative to its neighbours';
                         * 0: no limit, as it must be if oversample is below 2
                         */
    uint32_t error_ppm; /* relative error that the picture may have, as it is
                         * estimated; 0: the options alone say how good it is */
    uint32_t time_ms;   /* most time [ms] from the first tile on; 0: no limit */
    struct msg_hashes files; /* of the whole bundle, the manifest included */
    uint32_t nframes;
    const struct msg_frame *frames; /* NULL: in a file that is not read yet */
    /* with MSG_JOB_VIEWS: */
    const uint8_t *views;   /* hash of the file of frames, one of `files` */
    uint32_t width, height; /* the largest of any frame [pixels] */
    /* with MSG_JOB_SCENE: */
    const uint8_t *scene; /* the same hash for two jobs on one scene */
    /* with MSG_JOB_REUSE: */
    const uint8_t *reuse; /* the job whose ambient cache is the first pass; in a
                           * SUBMIT zeros mean the user's last job that fits */
};

/* Rendered pixels a side of each pixel of the picture, from 1. */
static inline int
msg_oversample(const struct msg_spec *spec)
{
    return spec->oversample > 1 ? spec->oversample : 1;
}

/* Does the job go on until its picture is good enough, or its time is up? */
static inline bool
msg_has_goal(const struct msg_spec *spec)
{
    return spec->error_ppm > 0 || spec->time_ms > 0;
}

/* Reply to SUBMIT: the job is in the queue, and its files are stored. */
struct msg_accept {
    const uint8_t *job;
    uint8_t again; /* 1: it was in the queue before; now attached to it */
    const uint8_t *reuse; /* the job whose ambient cache it begins with; zeros:
                           * no job's */
};

/* Pixels whose values were no numbers, infinite or negative, and are black. */
struct msg_nan {
    uint64_t pixels;
    uint32_t frame, x, y; /* the first such pixel, by frame, y, x; 0 when there
                           * is none */
};

/* A function that failed to give a value: the number of its object in the
 * scene, and how often it failed.  A message has the first MSG_FAULTS by
 * number; a count of 0 ends the list. */
#define MSG_FAULTS 4
struct msg_fault {
    uint32_t object;
    uint64_t count;
};

/* States of a PROGRESS that clients react to. */
#define MSG_STATE_WAITING   0
#define MSG_STATE_RUNNING   1
#define MSG_STATE_PAUSED    2
#define MSG_STATE_FAILED    4
#define MSG_STATE_CANCELLED 5
#define MSG_STATE_HELD      6

/* A share of the light that -ab leaves out is told to people from here on: less
 * is lost in the error that is told beside it. */
#define MSG_LEFT_OUT_TOLD .01

struct msg_progress {
    const uint8_t *job; /* zero: the job is not accepted yet */
    uint8_t state;      /* enum job_state of daemon/jobs/job.h: 0 waiting,
                         * 1 running, 2 paused, 3 done, 4 failed,
                         * 5 cancelled; or MSG_STATE_HELD: the coordinator has
                         * no room on its disk */
    uint64_t pixels_done, pixels_total;
    uint32_t units_done, units_total, units_redone;
    double cost_done, cost_total; /* estimated, in one unit; a unit under way
                                   * counts by the share of its pixels that
                                   * passes are past */
    uint64_t rays;
    uint32_t workers;      /* that work on the job now */
    uint32_t frames_ready; /* the first so many frames can be fetched */
    double elapsed_s;      /* from SUBMIT to the end, or now */
    double left_s;         /* until the end, as estimated; 0: unknown */
    struct msg_nan nan;    /* in the units that are done; frame is its number */
    struct msg_fault faults[MSG_FAULTS]; /* in the units that are done */
    double error; /* estimated relative error of these units; 0: unknown */
    double left_out; /* share of their light that comes by more bounces than
                      * -ab; 0: unknown */
    /* with --error or --time: */
    uint8_t stage;     /* that is under way, or was last; the first is 0 */
    uint8_t ended;     /* 1: no stage follows; rungs are the pictures' */
    uint8_t rungs[2];  /* how much finer the options are, of cache and of
                        * pixels: whole rungs, and quarters in the upper two
                        * bits */
    double goal_error; /* relative, as estimated when a stage ended; 0: no stage
                        * has ended */
};

/* The share of the job's work that is done: by its estimated cost; or by its
 * rows if that is more, for costs are known of whole units. */
static inline double
msg_progress_share(const struct msg_progress *p)
{
    double cost = p->cost_total > 0 ? p->cost_done / p->cost_total : 0;
    double rows = p->pixels_total > 0
                      ? (double)p->pixels_done / (double)p->pixels_total
                      : 0;

    return cost > rows ? cost : rows;
}

struct msg_done {
    const uint8_t *job;
    uint32_t frames;
};

/* A job failed, or the request that this answers; the job's id is zero if the
 * request was about no job. */
struct msg_failed {
    const uint8_t *job;
    uint16_t status;
    const char *text;
};

#endif
