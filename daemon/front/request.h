/* request.h - requests of users, admins and observers to the coordinator
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REQUEST_H
#define DAEMON_REQUEST_H

#include "desk/desk.h"

/* Handle a message of a connection in the session MSG_AT_COORD_USER, _ADMIN or
 * _OBSERVER. */
void request_handle(struct coord *c, struct coord_conn *conn,
                    const struct msg *m);

#endif
