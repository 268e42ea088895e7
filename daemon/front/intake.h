/* intake.h - users send files of scenes, and submit jobs
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_INTAKE_H
#define DAEMON_INTAKE_H

#include "desk/desk.h"

/* Handler of OFFER: ask the store for those files that the user may know to be
 * here. */
void intake_offer(struct coord *c, struct coord_conn *conn,
                  const struct msg *m);

/* The store's answer: send WANT with the files that are lacking. */
void intake_looked(struct coord *c, struct coord_conn *conn,
                   const struct action_look *l);

/* Handler of CHUNK: give a piece of a file to the store, if the user may send
 * the file. */
void intake_chunk(struct coord *c, struct coord_conn *conn,
                  const struct msg *m);

/* Handler of SUBMIT: take a new job, or let the user watch a job that is here
 * already. */
void intake_submit(struct coord *c, struct coord_conn *conn,
                   const struct msg *m);

#endif
