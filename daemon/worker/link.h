/* link.h - events of a worker's links to other workers
 *
 * The coordinator names a pair of workers to each other with a token; one of
 * the pair dials and says PEER_HELLO.  The hello may come before the other has
 * heard from the coordinator, so an unexpected hello is kept for a while.
 * Thread: one. */
#ifndef DAEMON_LINK_H
#define DAEMON_LINK_H

#include "worker/wjob.h"

void link_introduce(struct worker *w, struct wjob *job,
                    const struct msg_job_peers *m);
void link_accepted(struct worker *w, uint64_t conn);
/* Is that connection a peer's or a caller's?  Then the event is dealt with. */
bool link_opened(struct worker *w, uint64_t conn);
bool link_closed(struct worker *w, uint64_t conn);
bool link_message(struct worker *w, uint64_t conn, const struct msg *m);
bool link_written(struct worker *w, uint64_t conn, size_t n);
/* Records from the job's own child go to the peers. */
void link_spread(struct worker *w, struct wjob *job,
                 const struct msg_ambient *m);
/* Dial again, and close callers that say nothing. */
void link_tick(struct worker *w);
/* Close and free the links of a job; of all callers. */
void link_release_job(struct worker *w, struct wjob *job);
void link_release_callers(struct worker *w);

#endif
