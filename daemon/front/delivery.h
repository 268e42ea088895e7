/* delivery.h - pictures, previews and statistics for those who fetch them
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DELIVERY_H
#define DAEMON_DELIVERY_H

#include "desk/desk.h"

/* A FETCH: what is on the disk the store sends; statistics of a job that is in
 * memory are made, of one with many units piece by piece. */
void delivery_fetch(struct coord *c, struct coord_conn *conn,
                    const struct msg *m);

/* Make or send one piece of statistics for each connection that waits. */
void delivery_tick(struct coord *c);

#endif
