/* worker_says.h - messages from the coordinator and from children; a job's end
 *
 * Thread: radd's loop. */
#ifndef DAEMON_WORKER_SAYS_H
#define DAEMON_WORKER_SAYS_H

#include "worker/state.h"

void worker_from_coord(struct worker *w, const struct msg *m);
void worker_from_child(struct worker *w, struct wjob *job, const struct msg *m);
/* End children that said nothing for too long although they have work. */
void worker_watch_children(struct worker *w);
/* The job is over: end its child, and forget the job. */
void worker_end_job(struct worker *w, struct wjob *job);

#endif
