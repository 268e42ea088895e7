/* linking.h - which workers of a job are linked with which
 *
 * Two workers are linked when one needs base lines, or records of tiles, of the
 * other; a worker with 16 links or more loses its oldest link for that.
 * Workers that are not linked send each other base lines and records by way of
 * the coordinator.  With --ambient=live a worker sends each record to all
 * workers that it is linked with: all others, or of more than 256 those that
 * were there before it came; it does not get the records that still older
 * workers make.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LINKING_H
#define DAEMON_LINKING_H

#include "desk/desk.h"

/* A worker became ready: link it with all others, if the job shares live
 * records. */
void linking_join(struct coord *c, struct job *job, uint32_t index);
/* A worker is gone: end its links. */
void linking_left(struct coord *c, struct job *job, uint32_t index);

/* Can at least one of the two workers be dialled? */
bool linking_can(const struct coord_worker *a, const struct coord_worker *b);
/* Link workers a and b, unless they are linked or neither can be dialled.  Each
 * may lose its oldest link for that. */
void linking_need(struct coord *c, struct job *job, uint32_t a, uint32_t b);

/* Tell worker `to` to end its link with worker `about`. */
void linking_end(struct coord *c, const struct job *job,
                 const struct coord_worker *to,
                 const struct coord_worker *about);
/* Tell the other workers of a job to end their links with worker w. */
void linking_drop(struct coord *c, const struct job *job,
                  const struct coord_worker *w);

/* NULL is accepted. */
void linking_free(struct links *l);

#endif
