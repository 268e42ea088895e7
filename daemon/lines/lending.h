/* lending.h - columns of a line, for a worker that has nothing
 *
 * Thread: one. */
#ifndef DAEMON_LENDING_H
#define DAEMON_LENDING_H

#include "desk/desk.h"

/* Messages of workers. */
void lending_loan(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);
void lending_paid(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);

/* Ask for columns until as many are on their way as workers are idle. */
void lending_ask(struct coord *c, struct job *job, uint32_t idle);
/* An attempt has nothing left to do.  True: but to wait for what it lends. */
bool lending_parked(const struct coord *c, struct job_go *go);
/* Take back what is lent for too long. */
void lending_tick(struct coord *c, struct job *job);

#endif
