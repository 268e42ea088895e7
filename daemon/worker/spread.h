/* spread.h - how a worker's ambient records get about in a large job
 *
 * Up to a number of workers each has links to all, and sends its records to all
 * while they are in a hurry.  Else, and with more of them always, each has a
 * place on a ring (ring.h), or one on it that speaks for it, and the
 * coordinator has said to whom it sends what (RING).  Records from `distance`
 * places back go over those links whose `below` is more, if they have not been
 * all around then: so there is one way from each place to each other.  Records
 * of those for whom a worker speaks go about as its own do, and what it hears
 * they hear.
 *
 * What is under way when places change goes on by the links of before, if they
 * are still there; what waits for a link that is gone is lost.  That costs
 * time, and nothing else. Private to worker*.c and peer.c.  Thread: one. */
#ifndef DAEMON_SPREAD_H
#define DAEMON_SPREAD_H

#include "worker/state.h"

/* The links that count from now on; before that job->spread is NULL. */
void spread_set(struct worker *w, struct wjob *job, const struct msg_ring *m);

/* A peer was made known, anew or for the first time; or it is linked now. */
void spread_linked(struct wjob *job, const char *name, bool linked);

/* The job's own child made records.  True: they go to each peer by itself. */
bool spread_note_own(struct worker *w, struct wjob *job);

/* If not. */
void spread_own(struct worker *w, struct wjob *job,
                const struct msg_ambient *m);
/* Records that a peer made, or was asked to give; the child is the caller's. */
void spread_heard(struct worker *w, struct wjob *job, const struct wpeer *from,
                  const struct msg_ambient *m);

/* Records on their way: they go on, and to the child; without job->spread they
 * are dropped. */
void spread_take(struct worker *w, struct wjob *job,
                 const struct msg_spread *m);

/* What has waited for long goes out. */
void spread_tick(struct worker *w, struct wjob *job);

void spread_release(struct wjob *job);

#endif
