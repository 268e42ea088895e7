/* request.h - what users and admins ask of the coordinator
 *
 * Private to the coordinator's own files.
 * Thread: one. */
#ifndef DAEMON_REQUEST_H
#define DAEMON_REQUEST_H

#include "desk/desk.h"

/* A message that arrived in MSG_AT_COORD_USER or MSG_AT_COORD_ADMIN. */
void request_handle(struct coord *c, struct coord_conn *conn,
                    const struct msg *m);

/* The files of an OFFER are known: say which are wanted. */
void request_looked(struct coord *c, struct coord_conn *conn,
                    const struct action_look *l);

/* What the request was about is kept: answer it, once. */
void request_settled(struct coord *c, struct coord_conn *conn,
                     uint32_t request);

/* While the disk is full that may not be for long: do not let them wait. */
void request_tick(struct coord *c);

/* Is somebody being told of what the job has in memory? */
bool telling_of(const struct coord *c, const struct job *job);

/* The connection is gone. */
void telling_release(struct coord_conn *conn);

#endif
