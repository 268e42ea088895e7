/* stages.h - a job that goes on until its picture is good enough, or time is up
 *
 * Its ambient cache comes in stages (refine/refine.h): each has its own
 * options, passes from an empty cache on (the first stage may begin with that
 * of a former job), and a check pass at their end, whose tiles say how far off
 * a picture would be.  Then it is decided: that is good enough, or which
 * options the next stage has.  By the error alone the decision is a function of
 * the job; by the clock it is not, and so it is kept.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_STAGES_H
#define DAEMON_STAGES_H

#include "desk/desk.h"
#include "jobs/goal.h"
#include "refine/refine.h"

/* The sizes of a job's pictures, malloc'd; NULL: memory is out. */
struct rad_pass_size *stages_sizes(const struct msg_spec *spec);

/* Rendering options of its pictures, as far as that is known by now. RAD_EDATA:
 * its specification has none. */
int stages_params(const struct job *job, struct rad_params *out,
                  struct rad_error *err);

/* Are the records of a former job the first of the passes that are open? */
bool stages_reuse(const struct job *job);

/* The passes of its stage, the check pass as the last; or those of a job
 * without a goal.  RAD_EDATA. */
int stages_plan(const struct job *job, const struct rad_pass_size *size,
                struct rad_pass plan[RAD_MOST_PASSES], uint32_t *n,
                struct rad_error *err);

/* What the passes of a stage brought. */
struct stage_found {
    struct rad_refine_sums sums; /* of the check pass */
    uint64_t rays, check;        /* of the passes before it, and its own */
    double rays_s, check_s;      /* processor seconds of these */
};

/* The check pass, the last of n, is closed: end the stage.  The job's goal says
 * with which options the next one is made, or, true: none follows, pictures. */
bool stages_end(struct coord *c, struct job *job, uint32_t n,
                const struct stage_found *found);

/* The decision, as it is kept. */
#define STAGES_BYTES 38
void stages_pack(struct coord *c, const struct job *job,
                 uint8_t out[STAGES_BYTES]);

/* Take up what earlier lives of the coordinator decided, from the passes that
 * are kept; those of stages that are past are dropped but for what they
 * counted. RAD_EDATA, RAD_ENOMEM. */
int stages_take_up(struct coord *c, struct job *job, struct rad_error *err);
/* After that: are there rows of its picture, but the decision that they were
 * made by is lost?  The job cannot go on: says why, or NULL. */
const char *stages_lost(const struct job *job);

#endif
