/* introduce.h - workers of a job are named to each other, so that one dials
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_INTRODUCE_H
#define DAEMON_INTRODUCE_H

#include "desk/desk.h"

/* Link a worker that just became ready with the workers that are, those that
 * came before it first, and `most` at most; the first of these gives it the
 * records of its cache. */
void introduce_worker(struct coord *c, const struct job *job, uint32_t index,
                      uint32_t most);
/* Tell the other workers of a job to end their links with this worker. */
void introduce_drop(struct coord *c, const struct job *job,
                    const struct coord_worker *w);
/* Can one of the two be dialled by the other? */
bool introduce_can(const struct coord_worker *a, const struct coord_worker *b);
/* Tell two workers of a job of each other; a may be asked to give b the records
 * of its cache (MSG_PEER_GIVE).  False: neither can be dialled. */
bool introduce_link(struct coord *c, const struct job *job,
                    const struct coord_worker *a, const struct coord_worker *b,
                    uint32_t give);
/* Tell a worker to end its link with another. */
void introduce_unlink(struct coord *c, const struct job *job,
                      const struct coord_worker *to,
                      const struct coord_worker *about);

#endif
