/* linking.h - which workers of a job are linked with which
 *
 * Up to 64 workers are all linked with each other.  In a job of more, two are
 * linked when one comes to need base lines or records of tiles of the other, up
 * to a number of such links; without a link these go by way of the coordinator.
 * With --ambient=live each record goes to all workers at once, so there a
 * worker that comes is linked with each, or with the 256 that came just before
 * it: a worker does not hear of records of those that came long before.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LINKING_H
#define DAEMON_LINKING_H

#include "desk/desk.h"

/* A worker of a job whose workers are linked became ready. */
void linking_join(struct coord *c, struct job *job, uint32_t index);
/* A worker of any job is gone. */
void linking_left(struct coord *c, struct job *job, uint32_t index);

/* Link two workers, if they are not linked and one can be dialled.  Of many
 * workers that may end the oldest link of each. */
void linking_need(struct coord *c, struct job *job, uint32_t a, uint32_t b);

/* NULL is accepted. */
void linking_free(struct links *l);

#endif
