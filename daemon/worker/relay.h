/* relay.h - a worker passes on shared lines (facts, base lines, loans), and
 * tiles
 *
 * Thread: radd's loop. */
#ifndef DAEMON_RELAY_H
#define DAEMON_RELAY_H

#include "worker/wjob.h"

/* Pass on a message about shared lines or passes, down from the coordinator or
 * up from a job's child; other messages are ignored. */
void relay_down(struct worker *w, const struct msg *m);
void relay_up(struct worker *w, struct wjob *job, const struct msg *m);
/* A link to the named peer is up: send it the base lines that it waits for. */
void relay_linked(struct worker *w, struct wjob *job, const char *name);
/* The coordinator is gone, and with it all loans: children have their columns
 * again. */
void relay_cut(struct worker *w);
/* Send the coordinator all kept base lines again: it may have lost some. */
void relay_repeat(struct worker *w, const struct wjob *job);
/* The job ends: free its base lines. */
void relay_release(struct wjob *job);

#endif
