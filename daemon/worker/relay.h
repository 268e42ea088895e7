/* relay.h - what workers share, as it passes through one of them
 *
 * Thread: one. */
#ifndef DAEMON_RELAY_H
#define DAEMON_RELAY_H

#include "worker/wjob.h"

/* What workers share, on its way down from the coordinator and up from a job's
 * child; other messages are ignored. */
void relay_down(struct worker *w, const struct msg *m);
void relay_up(struct worker *w, struct wjob *job, const struct msg *m);
/* A link to a peer is there. */
void relay_linked(struct worker *w, struct wjob *job, const char *name);
/* The coordinator is gone, and so is all that it had lent on. */
void relay_cut(struct worker *w);
/* Tell the coordinator all of them again: some may have been lost on the way.
 */
void relay_repeat(struct worker *w, const struct wjob *job);
/* A link to a peer is there. */
void relay_release(struct wjob *job);

#endif
