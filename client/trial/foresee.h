/* foresee.h - a short trial of a job's scene while the job is under way
 *
 * The trial of --dry-run with less effort, on a thread of radsubmit's own.  It
 * tells how many rays the job will take, long before what the workers do tells
 * (eta.h).  The job pays for it where both are on one machine, so it is begun
 * for none that is soon over: what it takes is a few hundredths of what it is
 * told about.  It has the priority of radsubmit, for beside workers that keep
 * all processors busy it would come too late at a lower one, and cost as much.
 * Thread: one, but for foresee's own. */
#ifndef RADD_CLIENT_FORESEE_H
#define RADD_CLIENT_FORESEE_H

#include "proto/message.h"
#include "trial/trial.h"

struct foresee;

/* What is tried; all of it must stay until foresee_end() is
 * true. */
struct foresee_job {
    const struct rad_scene *scene;
    struct rad_files files;
    const struct rad_params *params;
    const struct msg_frame *frames;
    uint32_t nframes;
};

/* Begin.  NULL: there is no thread or memory for it, and nobody needs it. */
struct foresee *foresee_begin(const struct foresee_job *job);

/* Rays of the whole job; 0: not known yet, or the trial failed. */
double foresee_rays(const struct foresee *f);

/* The job is over: stop and free it, which takes as long as a pixel does that
 * it is at.  Who is in a hurry does not wait for that: then it is false, and
 * the program must end with all that is tried where it is.  NULL is fine. */
bool foresee_end(struct foresee *f, bool hurry);

#endif
