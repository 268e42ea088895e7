/* gather.h - a worker gathers the records of tiles until their pass is closed
 *
 * They come from the coordinator or from a peer, and are passed on to the peers
 * that this worker feeds.  When a pass is closed and all its records are here,
 * the child gets them in the order of tiles; if some are lacking the
 * coordinator is told.
 * Thread: radd's loop. */
#ifndef DAEMON_GATHER_H
#define DAEMON_GATHER_H

#include "worker/wjob.h"

/* Handlers of TILE_RECORDS, CLOSED and FEED; the first also comes from peers.
 */
void gather_take(struct worker *w, struct wjob *job,
                 const struct msg_tile_records *m);
void gather_closed(struct worker *w, struct wjob *job,
                   const struct msg_closed *m);
void gather_feed(struct worker *w, struct wjob *job, const struct msg_feed *m);

/* The child has got the next pass as FROZEN from the coordinator. */
void gather_frozen(struct worker *w, struct wjob *job);
/* The child begins with other passes, or the coordinator with another life:
 * forget which passes are closed, and records that are of no use. */
void gather_turn(struct wjob *job);
/* Tell the coordinator if records of a closed pass have not come for a while.
 */
void gather_tick(struct worker *w, struct wjob *job);
void gather_release(struct wjob *job);

#endif
