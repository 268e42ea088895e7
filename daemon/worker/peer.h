/* peer.h - a worker's links to the other workers of a job
 *
 * What worker*.c, peer.c and relay.c ask of the latter two, which share
 * worker_impl.h with them.  Private to these.
 *
 * The coordinator names a pair of workers to each other with a token; one
 * dials and says PEER-HELLO.  That may come before the coordinator's word, so
 * a hello that fits nothing yet is kept for a while.
 * Thread: one. */
#ifndef DAEMON_PEER_H
#define DAEMON_PEER_H

#include "worker/worker_impl.h"

/* --- peer.c --- */

void peer_introduce(struct worker *w, struct wjob *job,
                    const struct msg_job_peers *m);
void peer_accepted(struct worker *w, uint64_t conn);

/* Is that connection a peer's or a caller's?  Then the event is dealt with. */
bool peer_opened(struct worker *w, uint64_t conn);
bool peer_closed(struct worker *w, uint64_t conn);
bool peer_message(struct worker *w, uint64_t conn, const struct msg *m);
bool peer_written(struct worker *w, uint64_t conn, size_t n);

/* Records from the job's own child go to the peers; what waits for the child
 * goes as far as it takes it. */
void peer_spread(struct worker *w, struct wjob *job,
                 const struct msg_ambient *m);
void peer_feed_child(struct worker *w, struct wjob *job);

/* The same for records from elsewhere; they count as come in. */
void peer_receive(struct worker *w, struct wjob *job,
                  const struct msg_ambient *m);

/* The peer of that name, linked or not yet; NULL: there is none.  And send it a
 * frame of records that is in w's scratch, or keep that for a while until it is
 * linked.  *kept is NULL for the first of several who are sent the same. */
struct wpeer *peer_named(const struct wjob *job, const char *name);
void peer_records(struct worker *w, struct wjob *job, struct wpeer *p,
                  uint8_t **kept);

/* The peer of that name, but for one that should have called by now. */
struct wpeer *peer_awaited(const struct worker *w, const struct wjob *job,
                           const char *name);
/* The peer of that name, if there is a link to it; else NULL. */
struct wpeer *peer_linked(const struct wjob *job, const char *name);
/* Send it what may not be dropped. */
void peer_send(struct worker *w, struct wjob *job, struct wpeer *p,
               const struct msg *m);

/* Dial again, and close callers that say nothing. */
void peer_tick(struct worker *w);

/* Close and free the links of a job; of all callers. */
void peer_release_job(struct worker *w, struct wjob *job);
void peer_release_callers(struct worker *w);

/* --- relay.c --- */

/* What workers share, on its way down from the coordinator and up from a job's
 * child; other messages are ignored. */
void relay_down(struct worker *w, const struct msg *m);
void relay_up(struct worker *w, struct wjob *job, const struct msg *m);
/* A link to a peer is there. */
/* The coordinator is gone, and so is all that it had lent on. */
void relay_cut(struct worker *w);
void relay_linked(struct worker *w, struct wjob *job, const char *name);
/* Tell the coordinator all of them again: some may have been lost on the way.
 */
void relay_repeat(struct worker *w, const struct wjob *job);
/* May that be a base line of the job? */
bool relay_fits(const struct wjob *job, const struct msg_base_line *m);
void relay_release(struct wjob *job);

#endif
