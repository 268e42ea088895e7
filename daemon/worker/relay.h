/* relay.h - shared lines (facts, base lines, loans), and tiles of passes, on
 * their way through a worker
 *
 * Thread: one. */
#ifndef DAEMON_RELAY_H
#define DAEMON_RELAY_H

#include "worker/wjob.h"

/* A message about shared lines or passes, down from the coordinator or up from
 * a job's child; other messages are ignored. */
void relay_down(struct worker *w, const struct msg *m);
void relay_up(struct worker *w, struct wjob *job, const struct msg *m);
/* A link to a peer is there. */
void relay_linked(struct worker *w, struct wjob *job, const char *name);
/* The coordinator is gone, and with it all loans that it had arranged. */
void relay_cut(struct worker *w);
/* Send all base lines to the coordinator again: some may have been lost. */
void relay_repeat(struct worker *w, const struct wjob *job);
/* The job is over: forget its base lines. */
void relay_release(struct wjob *job);

#endif
