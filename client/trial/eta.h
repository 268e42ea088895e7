/* eta.h - how long a job will still take
 *
 * Pixels are a bad measure: while the ambient cache fills, the first tenth of
 * them may take half of the time, and base lines are made before any row is
 * complete.  Rays are a good one: a cluster makes about as many in each second,
 * from the first to the last.  So the time left is the number of rays that are
 * left, divided by the rate at which they come.
 *
 * That number is known from two sources.  A trial tells it before anything is
 * done (trial.h, foresee.h).  The share of the picture that is done tells it,
 * if the rest costs as much as the first part did; this is too much at first.
 * Both are weighed by that share.  Without a trial there is no result at first.
 * In a job whose ambient cache comes in passes the share includes these and
 * grows evenly with the work: there no trial is made.
 * Thread: one. */
#ifndef RADD_CLIENT_ETA_H
#define RADD_CLIENT_ETA_H

#include <stdbool.h>

/* A report about a job. */
struct eta_look {
    double elapsed_s; /* since the job began */
    double done;      /* share of the picture, or of its cost, 0 to 1 */
    double rays;      /* so far; 0: not known yet */
    bool working;     /* workers are at it: it neither waits nor is paused */
};

/* All 0: the job has not begun. */
struct eta {
    double foreseen;          /* rays of the whole job; 0: not known */
    bool awaited;             /* a trial runs, so its result will come */
    double work_s;            /* working time since rays came */
    double rate;              /* rays a second */
    double last_s, last_rays; /* of the last report */
};

/* Take a report.  Returns the seconds that are left; < 0: not known. */
double eta_take(struct eta *e, const struct eta_look *look);

/* A trial's result: the rays of the whole job; 0: the trial has begun. */
void eta_foresee(struct eta *e, double rays);

/* Seconds that are left by the share alone, which is too much at first;
 * INFINITY: not known.  For the decision whether a trial is worth its cost. */
double eta_by_share(const struct eta *e, double done);

#endif
