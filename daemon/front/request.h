/* request.h - what users and admins ask of the coordinator
 *
 * Private to the coordinator's own files.
 * Thread: one. */
#ifndef DAEMON_REQUEST_H
#define DAEMON_REQUEST_H

#include "desk/desk.h"

/* A message that arrived in MSG_AT_COORD_USER, _ADMIN or _OBSERVER. */
void request_handle(struct coord *c, struct coord_conn *conn,
                    const struct msg *m);

/* The store has looked for the files of an OFFER: say which are wanted. */
void request_looked(struct coord *c, struct coord_conn *conn,
                    const struct action_look *l);

/* The store keeps the change that was asked for: answer the request, once. */
void request_settled(struct coord *c, struct coord_conn *conn,
                     uint32_t request);

/* Go on with answers that take a while; while the disk is full, tell users
 * whose changes cannot be kept now. */
void request_tick(struct coord *c);

#endif
