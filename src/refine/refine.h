/* refine.h - the stages of a job that goes on until its picture is good enough
 *
 * A stage has options, passes and a cache.  The options are the job's own,
 * finer by rungs: rungs of the cache, and rungs of pixels; -ab, -lr, -ps and
 * the size are the same in all stages.  The passes fill the cache with these
 * options (passes/passplan.h).  The cache is empty at first, unless the job's
 * first stage has these options and the records of a former job.  The last pass
 * is the check pass: its tiles make no records, but sums that say how far off a
 * picture over that cache would be (recheck.h).
 * Errors are relative, root mean squares over areas of 5 by 5 written pixels,
 * as a picture's own estimate is (picture/doubt.h).
 * All results are functions of the arguments alone, the same to the bit on all
 * machines; no scene is needed.
 * Thread: any. */
#ifndef RAD_REFINE_REFINE_H
#define RAD_REFINE_REFINE_H

#include "passes/passplan.h"
#include "picture/doubt.h"

/* The most stages of a job. */
#define RAD_REFINE_STAGES 4

/* The sums that tiles of a check pass find; all add up. */
struct rad_refine_sums {
    struct rad_doubt doubt;
    struct rad_doubt_off off;
    double shown, rays; /* pixels of windows, and the rays of these */
};

/* Add a tile's sums.  The last bits of the sum depend on the order: add tiles
 * in the order of their numbers. */
void rad_refine_add(struct rad_refine_sums *to,
                    const struct rad_refine_sums *tile);

/* Are pictures with so many pixels in all so small that a check has few tiles,
 * which look at all areas of their windows? */
bool rad_refine_is_small(const struct rad_params *par, uint64_t pixels);

/* Plan the passes of a job with these options; check: of a stage, whose last
 * pass is a check pass.  on: the cache begins with the records of a former job,
 * as in rad_passes_plan_on().  Returns the number of passes; 0: there is no
 * cache, or no room for the check pass. */
uint32_t rad_refine_plan(const struct rad_params *par,
                         const struct rad_pass_size *size, uint32_t nsizes,
                         bool on, bool check,
                         struct rad_pass pass[RAD_MOST_PASSES]);

/* How much finer options are than the job's own, in quarters of a rung.  The
 * cache's error is halved by some three rungs at first, later by five; the
 * pixels' error by four.  The first rung of pixels is finer options for direct
 * light.  Further rungs are more rays of a pixel; only pictures have these, for
 * stages do not need them.  Stages that aim at an error have whole rungs, and
 * pictures quarters; where time is short stages have quarters, too, to use more
 * of the time.  Rungs above RAD_REFINE_MOST_* count as these. */
#define RAD_REFINE_RUNG 4
struct rad_refine_rungs {
    uint8_t ambient, pixel;
};
#define RAD_REFINE_MOST_AMBIENT (32 * RAD_REFINE_RUNG)
#define RAD_REFINE_MOST_PIXEL   (13 * RAD_REFINE_RUNG)

/* Set *out to the options of a stage; with rungs {0, 0} they are the job's. */
void rad_refine_params(const struct rad_params *job,
                       struct rad_refine_rungs rungs, struct rad_params *out);

/* Do options with rungs a and b differ in --samples at most?  Then pictures
 * with a can be made over a cache that was made with b. */
bool rad_refine_same_cache(struct rad_refine_rungs a,
                           struct rad_refine_rungs b);

/* Give *job the options of a former job's pictures, if these are at least as
 * fine in all that rungs change for the cache and for light.  False: they are
 * not, and *job is unchanged. */
bool rad_refine_join(struct rad_params *job, const struct rad_params *former);

/* What the checks of all stages so far say together, at the rungs of the last
 * one: squares of errors, noise a part of pixel, and the number of places that
 * they looked at.  Zeros: there is no stage. */
struct rad_refine_known {
    struct rad_refine_rungs rungs;
    double ambient, pixel, noise;
    double places;
};

struct rad_refine_ask {
    double error;                  /* the wanted error; 0: none is wanted */
    uint32_t stage;                /* number of the stage just made, from 0 */
    struct rad_refine_rungs rungs; /* of that stage */
    struct rad_refine_sums sums;   /* of its check pass */
    struct rad_refine_known past;  /* by the stages before */
    uint64_t rays;                 /* of its passes, but the check pass */
    uint64_t check;                /* rays of its check pass */
    uint64_t pixels;               /* of all pictures */
    int samples; /* rays of a pixel by the job's options, from 1 */
    double left_s; /* until the time is up; INFINITY: there is no limit */
    /* With a limit: seconds for a ray of the passes, and for a ray of the check
     * pass, by all workers together; 0: not known. */
    double pass_s, look_s;
};

/* Should another stage be made?  False: the wanted error is reached, or no
 * stage is worth its rays, or the job has had RAD_REFINE_STAGES, or no stage
 * would be done in time or, without a limit of time, within the rays that a
 * stage may take.
 * *next: the rungs of that stage; or, with false, of the pictures, which have
 * the light of the stage just made.  *error: the error of a picture that is
 * made now; or, with false, of the pictures that are made. */
bool rad_refine_next(const struct rad_refine_ask *ask,
                     struct rad_refine_rungs *next, double *error);

/* Did rad_refine_next() end the stages only because time, or rays, ran out? */
bool rad_refine_is_short(const struct rad_refine_ask *ask);

/* Would rad_refine_next() decide otherwise with time for any stage? */
bool rad_refine_by_clock(const struct rad_refine_ask *ask);

/* Make rad_refine_ask.past for the question after the next stage. */
struct rad_refine_known rad_refine_pass_on(const struct rad_refine_ask *ask);

/* By how much the mean of all pixels would be off after the stage. */
double rad_refine_mean(const struct rad_refine_sums *sums);

#endif
