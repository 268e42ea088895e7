/* coord_conn.h - connections to the coordinator: their users and their roles
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_CONN_H
#define DAEMON_COORD_CONN_H

#include "desk/desk.h"

/* A connection has ended: note that its worker is gone; why is for the log. */
void coord_conn_closed(struct coord *c, uint64_t id, const char *why);
/* A connection was accepted. */
void coord_conn_opened(struct coord *c, uint64_t id,
                       const struct coord_peer *peer);

/* Handler of HELLO: welcome the connection, or refuse it. */
void coord_hello(struct coord *c, struct coord_conn *conn, const struct msg *m);

/* Carry out the verdicts on connections (desk/verdict.h). */
void coord_end_conns(struct coord *c);

/* The worker of that name, made if need be; NULL: memory is out. */
struct coord_worker *coord_worker_of(struct coord *c, const char *name);
/* Free the workers that were forgotten and have no part in any job. */
void coord_drop_forgotten(struct coord *c);

#endif
