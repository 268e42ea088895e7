/* intake.h - what users send: files of scenes, and jobs
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_INTAKE_H
#define DAEMON_INTAKE_H

#include "desk/desk.h"

/* Which files of a scene are wanted?  The store is asked to look for those that
 * the user may know to be here. */
void intake_offer(struct coord *c, struct coord_conn *conn,
                  const struct msg *m);

/* The store has looked: say which are wanted. */
void intake_looked(struct coord *c, struct coord_conn *conn,
                   const struct action_look *l);

/* A piece of a file, which goes to the store if its user may send it. */
void intake_chunk(struct coord *c, struct coord_conn *conn,
                  const struct msg *m);

/* A job, new or here already. */
void intake_submit(struct coord *c, struct coord_conn *conn,
                   const struct msg *m);

#endif
