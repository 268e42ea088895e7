/* turn.h - whose job is next for a worker
 *
 * Jobs of higher priority go first, and owners of jobs of one priority share
 * the workers' threads.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_TURN_H
#define DAEMON_TURN_H

#include "desk/desk.h"

/* Has the worker to load the job first?  index: the worker's in the job, or
 * JOB_NOBODY. */
bool turn_is_new(const struct job *job, uint32_t index);

/* Begin the worker's search for work, which has a number: coord.serving. */
void turn_begin(struct coord *c, const struct coord_worker *w);

/* The next job of this search that was not served in it: of those with the
 * highest priority the job whose owner has the fewest threads at work, of these
 * a job of an owner that the worker works for, of these the oldest.  news: jobs
 * that the worker has not loaded, too.  NULL: no job is left. */
struct job *turn_next(const struct coord *c, const struct coord_worker *w,
                      bool news);

/* Has the worker loaded this job for the time when its present units are done?
 * It loads one job ahead: of each more it would keep a child and a scene, and
 * thousands of jobs may wait behind one that takes hours. */
bool turn_is_ahead(const struct job *job, const struct coord_worker *w,
                   uint32_t index);

#endif
