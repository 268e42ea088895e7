/* worker_says.h - messages of the coordinator and of children; the end of a job
 *
 * Thread: one. */
#ifndef DAEMON_WORKER_SAYS_H
#define DAEMON_WORKER_SAYS_H

#include "worker/state.h"

void worker_from_coord(struct worker *w, const struct msg *m);
void worker_from_child(struct worker *w, struct wjob *job, const struct msg *m);
/* Lose children that hang, loading or with units in hand. */
void worker_watch_children(struct worker *w);
/* The job is over: end its child, and forget the job. */
void worker_end_job(struct worker *w, struct wjob *job);

#endif
