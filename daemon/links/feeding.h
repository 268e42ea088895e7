/* feeding.h - which worker passes records of tiles on to which
 *
 * In a large job the records of all tiles are too much for the coordinator to
 * send to each worker.  It sends them to a few, each of these to others, and so
 * on: a tree.  A worker that lacks records when their pass is closed gets them
 * from the coordinator, and another feeder.  The coordinator feeds workers that
 * failed others the least often.  So a link that breaks, or never comes to be,
 * or a worker that hangs, costs time alone.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_FEEDING_H
#define DAEMON_FEEDING_H

#include "desk/desk.h"

/* A worker became ready while passes are open: it has its place in the tree. */
void feeding_join(struct coord *c, struct job *job, uint32_t index);
/* A worker of any job is gone: those that it fed get other places. */
void feeding_left(struct coord *c, struct job *job, uint32_t index);
/* The worker lacked records of a pass that is closed. */
void feeding_lacked(struct job *job, uint32_t index);
/* Another pass is closed: workers that lacked records since the last such call,
 * though their feeders did not, get other places. */
void feeding_mend(struct coord *c, struct job *job);

/* Does the coordinator itself send the worker records of tiles? */
bool feeding_is_direct(const struct job *job, uint32_t index);

#endif
