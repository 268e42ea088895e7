/* coord_conn.h - who is connected to the coordinator, and as what
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_CONN_H
#define DAEMON_COORD_CONN_H

#include "desk/desk.h"

/* The connection is gone, for whatever reason; or a new one is there. */
void coord_conn_closed(struct coord *c, uint64_t id, const char *why);
void coord_conn_opened(struct coord *c, uint64_t id,
                       const struct coord_peer *peer);

/* A HELLO came: welcome the connection, or refuse it. */
void coord_hello(struct coord *c, struct coord_conn *conn, const struct msg *m);

/* Carry out the verdicts on connections (desk/verdict.h). */
void coord_end_conns(struct coord *c);

/* The record of the worker of that name, a new one if it never was here; NULL
 * when memory is out. */
struct coord_worker *coord_worker_of(struct coord *c, const char *name);
/* Free the workers that were forgotten and that no job names any more. */
void coord_drop_forgotten(struct coord *c);

#endif
