/* stages.h - the stages of a job with a goal: an error, or a limit of time
 *
 * A stage (refine/refine.h) has rendering options of its own and fills the
 * ambient cache in passes from empty (the first stage may begin with another
 * job's cache).  Its last pass is a check pass, whose tiles estimate the error
 * that a picture with these options would have.  Then the coordinator decides:
 * either the pictures follow, or another stage with better options.  Without a
 * limit of time the decision is a function of the job; with one it depends on
 * the clock, so it is kept on the disk.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_STAGES_H
#define DAEMON_STAGES_H

#include "desk/desk.h"
#include "jobs/goal.h"
#include "refine/refine.h"

/* The sizes of a job's pictures, malloc'd; NULL: memory is out. */
struct rad_pass_size *stages_sizes(const struct msg_spec *spec);

/* Rendering options of the present stage, or of the pictures once the goal has
 * ended.  RAD_EDATA: the options of the specification are wrong. */
int stages_params(const struct job *job, struct rad_params *out,
                  struct rad_error *err);

/* Does the present stage begin with another job's records as its first pass? */
bool stages_reuse(const struct job *job);

/* Has the job had as many stages as a job may have? */
bool stages_are_all(const struct job *job);

/* The passes of the present stage, the check pass last; in a job without a
 * goal, all its passes.  Fails as stages_params(). */
int stages_plan(const struct job *job, const struct rad_pass_size *size,
                struct rad_pass plan[RAD_MOST_PASSES], uint32_t *n,
                struct rad_error *err);

/* The sums and costs of a stage. */
struct stage_found {
    struct rad_refine_sums sums; /* of the check pass */
    uint64_t rays, check;        /* rays of other passes; of the check pass */
    double rays_s, check_s;      /* processor time of these rays [s] */
};

/* The check pass, the last of n passes, is closed: end the stage, and set in
 * the job's goal the options of the next stage or of the pictures.  True:
 * pictures follow. */
bool stages_end(struct coord *c, struct job *job, uint32_t n,
                const struct stage_found *found);

/* Write the last decision in the form in which it is kept on the disk. */
#define STAGES_BYTES 64
void stages_pack(struct coord *c, const struct job *job,
                 uint8_t out[STAGES_BYTES]);

/* After a restart: repeat the decisions that are kept among the passes.
 * Records of earlier stages are dropped, their counts are added to job->tiled.
 * RAD_EDATA, RAD_ENOMEM. */
int stages_take_up(struct coord *c, struct job *job, struct rad_error *err);
/* Called after stages_take_up().  Says why a job cannot go on that has rows of
 * its pictures, while the decision on their options is lost; NULL: it can. */
const char *stages_lost(const struct job *job);

#endif
