/* refine.h - the stages of a job that goes on until its picture is good enough
 *
 * A stage is a set of options, the passes that fill a cache under them
 * (passes/passplan.h) which is empty at first, unless the job's first stage
 * has those options and records of a former job, and a check pass, whose
 * tiles make no records but sums that say how far off a picture over that
 * cache would be (recheck.h).  Options are the job's own, finer by rungs:
 * those of the cache, and those of pixels.  Errors are relative, as root
 * mean squares over areas of 5 by 5 pixels, as a picture's own estimate is
 * (picture/doubt.h).  What all stages have in common (-ab, -lr, -ps, the
 * size) is no part of them.  All of this is a function of the job and the
 * sums: it is the same to the bit on all machines, and needs no scene.
 * Thread: any. */
#ifndef RAD_REFINE_REFINE_H
#define RAD_REFINE_REFINE_H

#include "passes/passplan.h"
#include "picture/doubt.h"

/* A job has at most so many stages. */
#define RAD_REFINE_STAGES 4

/* What tiles of a check pass find; all add up. */
struct rad_refine_sums {
    struct rad_doubt doubt;
    struct rad_doubt_off off;
    double shown, rays; /* pixels of windows, and what these took */
};

/* Of the order of tiles the sum depends, in its last bits. */
void rad_refine_add(struct rad_refine_sums *to,
                    const struct rad_refine_sums *tile);

/* The passes of a job, or of a stage, with these options; 0 if it has no cache.
 * on: it begins with the records of a former job, as in rad_passes_plan_on().
 * check: it is a stage, whose check pass is the last. */
uint32_t rad_refine_plan(const struct rad_params *par,
                         const struct rad_pass_size *size, uint32_t nsizes,
                         bool on, bool check,
                         struct rad_pass pass[RAD_MOST_PASSES]);

/* How much finer than the job's own options, in quarters of a rung.  The
 * cache's error is halved by some three rungs at first, later by five; that of
 * pixels by four.  The first rung of pixels is finer options for direct light;
 * further ones are rays of a pixel, which stages do not need: pictures alone
 * have them.  Stages that aim at an error have whole rungs, and pictures
 * quarters; where time is short stages have quarters, too, to use more of it.
 * More than RAD_REFINE_MOST_* is as these. */
#define RAD_REFINE_RUNG 4
struct rad_refine_rungs {
    uint8_t ambient, pixel;
};
#define RAD_REFINE_MOST_AMBIENT (32 * RAD_REFINE_RUNG)
#define RAD_REFINE_MOST_PIXEL   (13 * RAD_REFINE_RUNG)

/* The options of a stage; those of {0, 0} are the job's. */
void rad_refine_params(const struct rad_params *job,
                       struct rad_refine_rungs rungs, struct rad_params *out);

/* Do the options differ in --samples at most?  Then pictures with the one are
 * made over a cache, and by a job, that was made with the other. */
bool rad_refine_same_cache(struct rad_refine_rungs a,
                           struct rad_refine_rungs b);

/* Begin with the options of a former job's pictures, where all that rungs
 * change of its cache and of light is as fine there.  False: it is not, and
 * *job is as it was. */
bool rad_refine_join(struct rad_params *job, const struct rad_params *former);

/* The cache after the stage before: its rung, in quarters, and the square of
 * its error. */
struct rad_refine_past {
    uint8_t rung;
    double square;
};

struct rad_refine_ask {
    double error;                  /* that is wanted; 0: any */
    uint32_t stage;                /* that has been made, 0 for the first */
    struct rad_refine_rungs rungs; /* its */
    struct rad_refine_sums sums;   /* of its check pass */
    struct rad_refine_past past;   /* zeros: there is none before it */
    uint64_t rays;                 /* of its passes, but the check's */
    uint64_t check;                /* rays of that */
    uint64_t pixels;               /* of all pictures */
    int samples; /* rays of a pixel by the job's options, from 1 */
    double left_s; /* until the time is up; INFINITY: there is no limit */
    /* With a limit, seconds that a ray of the passes took all workers together,
     * and one of the check pass; 0: not known. */
    double pass_s, look_s;
};

/* Should another stage be made?  False: the error that is wanted is reached, or
 * no stage can come nearer, or the job has had all RAD_REFINE_STAGES, or none
 * would be done in time or, where time has no limit, in the rays that a stage
 * may take.  *next: the rungs of that stage, or those of the pictures, of the
 * same light as this stage's.  *error: of a picture now, or of those that are
 * made. */
bool rad_refine_next(const struct rad_refine_ask *ask,
                     struct rad_refine_rungs *next, double *error);

/* Is it for want of time, or rays, alone that none should? */
bool rad_refine_is_short(const struct rad_refine_ask *ask);

/* Would the decision be another if there were time for all? */
bool rad_refine_by_clock(const struct rad_refine_ask *ask);

/* What the next stage is to know of that. */
struct rad_refine_past rad_refine_pass_on(const struct rad_refine_ask *ask);

/* What the mean of all pixels would be off by after the stage. */
double rad_refine_mean(const struct rad_refine_sums *sums);

#endif
