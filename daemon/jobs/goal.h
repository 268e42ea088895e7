/* goal.h - a job's goal, and how far it is reached
 *
 * A goal is an error of the picture (--error) or a limit of time (--time).  A
 * job with a goal fills its ambient cache in stages, each with better options
 * than the stage before (filling/stages.h).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_GOAL_H
#define DAEMON_GOAL_H

#include "refine/refine.h"

#include <stdbool.h>
#include <stdint.h>

struct job;

enum goal_state {
    GOAL_AHEAD,   /* further stages may follow, or the job has no goal */
    GOAL_REACHED, /* no stage follows: pictures are made with .options over the
                   * cache of the last stage */
    GOAL_SHORT    /* the same, only because time, or the rays that a stage may
                   * take, ran out */
};

/* Zeros in a job without a goal. */
struct job_goal {
    enum goal_state state;
    uint32_t number;    /* of the present stage; else of the last stage */
    uint32_t base;      /* number of the present stage's first pass */
    uint8_t rungs[2];   /* the present options as struct rad_refine_rungs: whole
                         * rungs, and quarters of one in the upper two bits */
    struct rad_refine_known past; /* by the stages before */
    const char *options; /* the present options as text, in job.mem; NULL: the
                          * options of the specification */
    double error;        /* relative error as it was estimated at the end of the
                          * last stage; when no stage follows, the error that is
                          * foreseen for the pictures; 0: not estimated */
    double mean;         /* as error, of the mean of all pixels */
    uint64_t bytes;      /* size of the records of earlier stages, in this life
                          * of the coordinator */
    uint64_t spent_ms;   /* time spent until the last decision, in earlier
                          * lives of the coordinator */
    double begun_s;      /* seconds the job had spent when the stage began */
    bool by_clock;       /* with more time a decision would have been another */
    bool unread;         /* an earlier life kept a decision in a layout that
                          * this program does not read */
};

/* Did the stages end only because the time of --time ran out?  Did they, in a
 * job without --time, only because a stage may take no more rays? */
bool goal_time_up(const struct job *job);
bool goal_rays_up(const struct job *job);
/* Seconds since the first work on the job, those of earlier lives of the
 * coordinator included. */
double goal_spent_s(const struct job *job, uint64_t now_ms);
/* Rendering options of the job's pictures, as chosen so far: the goal's, else
 * the specification's. */
const char *goal_options(const struct job *job);

#endif
