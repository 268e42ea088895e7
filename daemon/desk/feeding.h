/* feeding.h - the tree in which workers of a job pass on records of tiles
 *
 * In a large job the coordinator cannot send the records of all tiles to each
 * worker.  It sends them to a few workers, each of these feeds others, and so
 * on: a worker's feeder is the worker that sends it records.  A worker that
 * lacks records when their pass is closed gets them from the coordinator, and
 * another feeder.  The coordinator itself feeds the workers that failed others
 * the least often.  So a link that breaks or never comes to be, or a worker
 * that hangs, costs only time.  Thread: the coordinator's loop. */
#ifndef DAEMON_FEEDING_H
#define DAEMON_FEEDING_H

#include "desk/desk.h"

/* Give a worker that became ready while passes are open its place in the tree.
 */
void feeding_join(struct coord *c, struct job *job, uint32_t index);
/* A worker is gone: give the workers that it fed other feeders. */
void feeding_left(struct coord *c, struct job *job, uint32_t index);
/* Note that the worker lacked records of a pass that is closed. */
void feeding_lacked(struct job *job, uint32_t index);
/* Called when a pass is closed: give another feeder to workers that lacked
 * records since the last call although their feeders had them. */
void feeding_mend(struct coord *c, struct job *job);

/* Does the coordinator itself send records of tiles to the worker? */
bool feeding_is_direct(const struct job *job, uint32_t index);

#endif
