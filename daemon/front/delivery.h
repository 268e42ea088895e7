/* delivery.h - users fetch pictures, previews and statistics
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DELIVERY_H
#define DAEMON_DELIVERY_H

#include "desk/desk.h"

/* Handler of FETCH.  The store sends what is on the disk.  Statistics of a job
 * that is in memory are made here, for many units piece by piece. */
void delivery_fetch(struct coord *c, struct coord_conn *conn,
                    const struct msg *m);

/* Make or send some more pieces of statistics, for the connections whose turn
 * it is. */
void delivery_tick(struct coord *c);

#endif
