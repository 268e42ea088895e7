/* foresee.h - a short trial of a job's scene while the job runs
 *
 * This is the trial of --dry-run with less effort, on a thread of radsubmit.
 * It tells how many rays the job will take, long before the workers' reports do
 * (eta.h).  On the same machine it takes time from the job, so it is only made
 * for a job that will still run for long, and costs a few hundredths of that
 * time.  It runs at radsubmit's priority: at a lower one it would come too late
 * beside workers that keep all processors busy, and cost as much.
 * Thread: one, besides the trial's own. */
#ifndef RADD_CLIENT_FORESEE_H
#define RADD_CLIENT_FORESEE_H

#include "trial/dryrun.h"

struct foresee;

/* Begin a trial.  What the job refers to must stay until foresee_end() returns
 * true.  NULL: no thread or no memory; the job goes on without it. */
struct foresee *foresee_begin(const struct dryrun_job *job);

/* Rays of the whole job; 0: not known yet, or the trial failed. */
double foresee_rays(const struct foresee *f);

/* Stop the trial and free it; waits until its current pixel is done.  hurry: do
 * not wait but return false; then the program must end without freeing anything
 * that the trial uses.  NULL is accepted. */
bool foresee_end(struct foresee *f, bool hurry);

#endif
