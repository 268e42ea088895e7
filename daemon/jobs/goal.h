/* goal.h - of a job that goes on until its picture is good enough, or its time
 * is up: how far it is
 *
 * It goes on in stages of its ambient cache's passes (filling/stages.h).
 * Thread: one. */
#ifndef DAEMON_GOAL_H
#define DAEMON_GOAL_H

#include <stdbool.h>
#include <stdint.h>

struct job;

/* Zeros in a job without a goal. */
struct job_goal {
    uint32_t number; /* of the stage whose passes are open, or were last */
    uint32_t base;   /* passes of the stages before it */
    /* of its options, struct rad_refine_rungs: whole ones, and quarters in the
     * upper two bits */
    uint8_t rungs[2];
    /* of the stage before it, struct rad_refine_past, likewise; zeros: there is
     * none */
    uint8_t past_rung;
    double past_square;
    const char *options; /* these, in mem; NULL: those of the specification */
    double error;        /* relative, as estimated at the end of the last stage
                          * that was looked at, and if it ended as pictures are
                          * foreseen to be; 0: none was */
    double mean;         /* and that of the mean of all pixels */
    uint64_t bytes;      /* of records of the stages before it, in this life */
    uint64_t spent_ms;   /* until the last decision, in earlier lives */
    double begun_s;      /* seconds spent when the stage began */
    bool ended;          /* no stage follows: the picture is made with .options,
                          * over the last one's cache */
    bool late;           /* for want of time, or of rays, alone */
    bool unread;         /* an earlier life kept a decision in another layout */
};

/* Has the job one? */
bool goal_is(const struct job *job);
/* Did it end for want of time alone, or, without a limit of time, of rays that
 * a stage may take? */
bool goal_time_up(const struct job *job);
bool goal_rays_up(const struct job *job);
/* Rendering options of its pictures, as far as that is known by now: those of
 * the goal, or of its specification. */
const char *goal_options(const struct job *job);

#endif
