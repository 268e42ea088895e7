/* spread.h - the ways of a worker's ambient records in a large job
 *
 * With --ambient=live each worker sends its records to all others, as long as
 * these are few; this is for jobs of many.  There each worker has a place on a
 * ring (links/ring.h), or is the guest of a host with a place, and the
 * coordinator has told it the links (RING).  Records from `distance` places
 * back go over those links whose `below` is greater, unless they have been all
 * around: so there is one way from each place to each other.  A host sends its
 * guests' records on like its own, and sends its guests all records that it
 * receives.
 *
 * Records under way when places change go on by the old links, if they are
 * still there; records that wait for a link that is gone are lost, which costs
 * time and nothing else.
 * Private to worker*.c and peer.c.
 * Thread: one. */
#ifndef DAEMON_SPREAD_H
#define DAEMON_SPREAD_H

#include "worker/state.h"

/* The links that count from now on; before that job->spread is NULL. */
void spread_set(struct worker *w, struct wjob *job, const struct msg_ring *m);

/* The coordinator named a peer (linked: false), or its link is there (true). */
void spread_linked(struct wjob *job, const char *name, bool linked);

/* The job's own child made records, and job->spread is there. */
void spread_own(struct worker *w, struct wjob *job,
                const struct msg_ambient *m);
/* Records that a peer made, or was asked to give; the child is the caller's. */
void spread_heard(struct worker *w, struct wjob *job, const struct wpeer *from,
                  const struct msg_ambient *m);

/* Records came over the ring: pass them on, and to the child; drop them if
 * there is no job->spread. */
void spread_take(struct worker *w, struct wjob *job,
                 const struct msg_spread *m);

/* Send the records that have waited for long. */
void spread_tick(struct worker *w, struct wjob *job);

void spread_release(struct wjob *job);

#endif
