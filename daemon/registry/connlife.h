/* connlife.h - connections to the coordinator: their users and their roles
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_CONNLIFE_H
#define DAEMON_CONNLIFE_H

#include "desk/desk.h"

/* A connection has ended: note that its worker is gone; why is for the log. */
void connlife_closed(struct coord *c, uint64_t id, const char *why);
/* A connection was accepted. */
void connlife_opened(struct coord *c, uint64_t id,
                     const struct coord_peer *peer);

/* Handler of HELLO: welcome the connection, or refuse it. */
void connlife_hello(struct coord *c, struct coord_conn *conn,
                    const struct msg *m);

/* Carry out the verdicts on connections (desk/verdict.h). */
void connlife_end_all(struct coord *c);

/* The worker of that name, made if need be; NULL: memory is out. */
struct coord_worker *connlife_worker(struct coord *c, const char *name);
/* Free the workers that were forgotten and have no part in any job. */
void connlife_drop_forgotten(struct coord *c);

#endif
