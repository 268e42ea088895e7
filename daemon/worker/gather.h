/* gather.h - records of tiles that any worker made, until their pass is closed
 *
 * They come from the coordinator, or from a peer, and go on to the peers that
 * this worker is to feed.  When the coordinator closes a pass whose records are
 * all here the child gets them, in the order of tiles; else the coordinator is
 * told that some are lacking.
 * Thread: one. */
#ifndef DAEMON_GATHER_H
#define DAEMON_GATHER_H

#include "worker/wjob.h"

/* Messages of the coordinator; TILE_RECORDS also of a peer. */
void gather_take(struct worker *w, struct wjob *job,
                 const struct msg_tile_records *m);
void gather_closed(struct worker *w, struct wjob *job,
                   const struct msg_closed *m);
void gather_feed(struct worker *w, struct wjob *job, const struct msg_feed *m);

/* The child got the next pass from the coordinator. */
void gather_frozen(struct worker *w, struct wjob *job);
/* The child has, or lacks, other passes than before, or the coordinator has
 * another life: forget those that are of no use, and which are closed. */
void gather_turn(struct wjob *job);
/* Say what has been lacking for long. */
void gather_tick(struct worker *w, struct wjob *job);
void gather_release(struct wjob *job);

#endif
