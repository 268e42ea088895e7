/* introduce.h - workers of a job are named to each other, so that one dials
 *
 * Thread: one. */
#ifndef DAEMON_INTRODUCE_H
#define DAEMON_INTRODUCE_H

#include "desk/desk.h"

/* Link a worker that just became ready with those that are; the first of them
 * gives it what its cache holds. */
void introduce_worker(struct coord *c, const struct job *job,
                      const struct coord_worker *w);
/* Tell the other workers of a job to have no more to do with this one. */
void introduce_drop(struct coord *c, const struct job *job,
                    const struct coord_worker *w);
/* Tell two workers of a job of each other; a may be asked to give b what its
 * cache has (MSG_PEER_GIVE).  False: neither can be dialled. */
bool introduce_link(struct coord *c, const struct job *job,
                    const struct coord_worker *a, const struct coord_worker *b,
                    uint32_t give);
/* Tell one to have no more to do with the other. */
void introduce_unlink(struct coord *c, const struct job *job,
                      const struct coord_worker *to,
                      const struct coord_worker *about);

#endif
