/* trial.h - what a picture will take, from a few of its pixels
 *
 * A scene is made ready as a worker does it, and pixels are traced through the
 * same code, for a second or two: some strewn over the picture, which fill the
 * ambient cache as the picture will, and then small windows, which the sampler
 * goes over with the cache that there is.  Where hemispheres are so large (-ad)
 * that this would not get far, it is done with small ones, and the first pixels
 * tell how much more the large ones take.  The rest is extrapolated
 * (trial_predict).
 * Thread: one, which it keeps busy.  */
#ifndef RADD_CLIENT_TRIAL_H
#define RADD_CLIENT_TRIAL_H

#include "picture/doubt.h"
#include "picture/frame.h"

#include <stdatomic.h>

/* What was measured. */
struct trial {
    double load_s; /* of one processor */
    double peak_bytes;
    int width, height;
    /* of pixels strewn over the picture, after each doubling of their number */
    struct trial_step {
        double pixels, rays, cpu_s, records;
    } step[40];
    int nsteps;
    /* of windows; what their pixels take the second time, when all records that
     * they ask for are there */
    double pixels, primary, rays, cpu_s, records;
    double again_primary, again_rays, again_cpu_s;
    /* of the first of the strewn pixels, where the above was measured with
     * smaller hemispheres than are asked for; pixels 0: it was not */
    struct trial_step full, small;
    double look_cpu_s; /* of windows, to make some of their pixels again */
    struct rad_doubt doubt; /* that these found, with the hemispheres that were
                             * tried */
    double samples; /* how many times larger a hemisphere is then */
};

/* What is to be expected of the picture, or of all frames. */
struct prediction {
    uint32_t points; /* sensor points; 0: there are pictures */
    double primary_rays, rays, ambient_values;
    double cpu_s;  /* of one processor like this one */
    double load_s; /* the part of it that each worker spends */
    double bytes;  /* a worker's memory */
    struct rad_error_estimate error; /* of the picture */
};

/* What is tried; the scene must be checked, files are its own. */
struct trial_scene {
    const struct rad_scene *scene;
    const struct rad_files *files;
    const struct rad_view *view;
    const struct rad_points *points; /* NULL: it is a picture, by the view */
};

/* How much it may take.  Below the least counts little is known, however long
 * they take. */
struct trial_effort {
    double seconds;           /* of a processor, about */
    int pixels;               /* strewn ones, at least */
    int windows;              /* at least ... */
    int side;                 /* ... and their size, TRIAL_SIDE at most */
    const _Atomic bool *stop; /* ends it within a pixel or a window; NULL:
                               * nothing does */
};

enum { TRIAL_SIDE = 64 };

/* Measure.  RAD_ETEMPFAIL when it was stopped. */
int trial_run(struct trial *t, const struct trial_scene *scene,
              const struct rad_params *params,
              const struct trial_effort *effort, struct rad_error *err);

/* The same so many times, one job after another. */
void trial_repeat(struct prediction *p, int times);

/* For so many pixels, of one picture or of all frames. */
void trial_predict(const struct trial *t, double pixels, struct prediction *p);

#endif
