/* eta.h - how long a job still takes, by what was foreseen and what came
 *
 * Pixels are a bad clock: while the ambient cache fills, the first tenth of
 * them may take half of the time, and base lines are made before any row is
 * there.  Rays are a good one: a cluster makes about as many in each second,
 * from the first to the last.  So the time left is the rays that are left, by
 * the pace at which they come.
 * How many are left two things tell: a trial, before anything is done (trial.h,
 * foresee.h); and the share of the picture that is there, which supposes that
 * the rest costs what the first part did, and is too long at first.  They are
 * weighed by that share.  Without a trial nothing is said at first.
 * Of a job whose ambient cache comes in passes the share counts these, too, and
 * goes with the work from the first on: then it soon tells more than the trial,
 * which knows nothing of passes.
 * Thread: one.  */
#ifndef RADD_CLIENT_ETA_H
#define RADD_CLIENT_ETA_H

#include <stdbool.h>

/* A report of a job. */
struct eta_look {
    double elapsed_s; /* since the job began */
    double done;      /* share of the picture or of its cost, 0..1 */
    double rays;      /* so far; 0: none are known yet */
    bool working; /* somebody is at it: it does not wait, nor is it paused */
};

/* All 0: of a job that has not begun. */
struct eta {
    double foreseen;          /* rays of the whole job; 0: not known */
    bool awaited;             /* a trial is under way, which will know better */
    bool even;                /* what is done goes evenly with the work: set it
                               * before the first report */
    double work_s;            /* that was worked, since rays came */
    double rate;              /* rays a second */
    double last_s, last_rays; /* of the last report */
};

/* Take a report.  Seconds that are left, < 0: not known. */
double eta_take(struct eta *e, const struct eta_look *look);

/* A trial says how many rays the whole job will take; 0: it is under way. */
void eta_foresee(struct eta *e, double rays);

/* Seconds that are left by the picture's share alone, which is too long at
 * first; INFINITY: not known.  Tells whether a trial is worth it. */
double eta_by_share(const struct eta *e, double done);

#endif
