/* ready.h - a worker has loaded a job
 *
 * The first worker that is ready has the job's units and passes laid out.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_READY_H
#define DAEMON_READY_H

#include "desk/desk.h"

/* Handler of READY. */
void ready_came(struct coord *c, struct coord_worker *w, const struct msg *msg);

#endif
