/* trial.h - what a picture will take, from a few of its pixels
 *
 * The scene is made ready as a worker does it, and for a second or two pixels
 * are traced by the same code: first pixels strewn over the picture, which fill
 * the ambient cache as the picture will; then small windows, which the sampler
 * goes over with that cache, and of which some pixels are made again, as the
 * job will do for its error.  The rest is extrapolated (trial_predict).
 * Thread: one, which it keeps busy. */
#ifndef RADD_CLIENT_TRIAL_H
#define RADD_CLIENT_TRIAL_H

#include "picture/doubt.h"

/* The measurements. */
struct trial {
    double load_s; /* processor time to load the scene */
    double peak_bytes;
    /* strewn pixels: the sums after each doubling of their number */
    struct trial_step {
        double pixels, rays, cpu_s, records;
    } step[40];
    int nsteps;
    /* windows: the sums of the first tracing; "again" of the second, of their
     * upper halves, when all records that they need exist */
    double pixels, primary, rays, cpu_s, records;
    double again_primary, again_rays, again_cpu_s;
    /* of their lower halves, and of the upper ones as much as the picture has
     * such a top: there as many pixels are traced as in the picture */
    double usual_pixels, usual_primary;
    struct rad_doubt doubt; /* sums over pixels of the windows, made again */
};

/* The prediction for a picture, or for all frames. */
struct prediction {
    uint32_t points; /* sensor points; 0: a job of pictures */
    double primary_rays, rays, ambient_values;
    double cpu_s;  /* time of one processor like this machine's */
    double load_s; /* the part of cpu_s that each worker spends */
    double bytes;  /* memory of a worker */
    struct rad_error_estimate error; /* the picture's */
};

/* What is tried.  The scene must be checked; files are those that it needs. */
struct trial_scene {
    const struct rad_scene *scene;
    const struct rad_files *files;
    const struct rad_view *view;
    const struct rad_points *points; /* NULL: a picture with that view */
    bool passes;                     /* its cache is filled in passes */
    int oversample;                  /* as in struct rad_frame */
};

/* With a cache a trial has at most TRIAL_BOUNCES.  In a trial a record has all
 * records made that its rays need, down to the last bounce, before it is done
 * itself, while passes make those by paths: with six bounces the first pixel of
 * a room with many objects would take minutes. */
enum { TRIAL_BOUNCES = 3 };

/* Measure. */
int trial_run(struct trial *t, const struct trial_scene *scene,
              const struct rad_params *params, struct rad_error *err);

/* The prediction for that many jobs, one after another. */
void trial_repeat(struct prediction *p, int times);

/* Predict for that many pixels, of one picture or of all frames. */
void trial_predict(const struct trial *t, double pixels, struct prediction *p);

#endif
