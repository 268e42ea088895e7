/* link.h - a worker's links to other workers
 *
 * The coordinator tells two workers of each other, with a token; one of them
 * dials the other and says PEER_HELLO.  That may arrive before JOB_PEERS does,
 * so an unexpected caller is kept for a while.
 * Thread: radd's loop. */
#ifndef DAEMON_LINK_H
#define DAEMON_LINK_H

#include "worker/wjob.h"

/* Handler of JOB_PEERS. */
void link_introduce(struct worker *w, struct wjob *job,
                    const struct msg_job_peers *m);
/* A peer dialled this worker. */
void link_accepted(struct worker *w, uint64_t conn);
/* Events of a connection; false: it is neither a peer's nor a caller's. */
bool link_opened(struct worker *w, uint64_t conn);
bool link_closed(struct worker *w, uint64_t conn, const char *why);
bool link_message(struct worker *w, uint64_t conn, const struct msg *m);
void link_written(struct worker *w, uint64_t conn, size_t n);
/* Send the peers records that the job's own child made. */
void link_spread(struct worker *w, struct wjob *job,
                 const struct msg_ambient *m);
/* Dial peers again, and close callers that say nothing. */
void link_tick(struct worker *w);
/* Close and free all links of a job; free all callers. */
void link_release_job(struct worker *w, struct wjob *job);
void link_release_callers(struct worker *w);

#endif
