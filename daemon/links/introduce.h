/* introduce.h - tell two workers of a job of each other, so that they link
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_INTRODUCE_H
#define DAEMON_INTRODUCE_H

#include "desk/desk.h"

/* Tell a worker that became ready and the job's other ready workers of each
 * other: at most `most` of these, beginning with the worker that came just
 * before it. */
void introduce_worker(struct coord *c, const struct job *job, uint32_t index,
                      uint32_t most);
/* Tell the other workers of a job to end their links with worker w. */
void introduce_drop(struct coord *c, const struct job *job,
                    const struct coord_worker *w);
/* Can at least one of the two workers be dialled? */
bool introduce_can(const struct coord_worker *a, const struct coord_worker *b);
/* Tell two workers of a job of each other.  False: neither can be dialled. */
bool introduce_link(struct coord *c, const struct job *job,
                    const struct coord_worker *a, const struct coord_worker *b);
/* Tell worker `to` to end its link with worker `about`. */
void introduce_unlink(struct coord *c, const struct job *job,
                      const struct coord_worker *to,
                      const struct coord_worker *about);

#endif
