/* lending.h - columns of a busy worker's line, for an idle worker
 *
 * Thread: the coordinator's loop. */
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
/* An attempt has nothing left to trace (PARKED).  True: it waits for columns
 * that it lent. */
bool lending_parked(const struct coord *c, struct job_go *go);
/* Take back loans that are late. */
void lending_tick(struct coord *c, struct job *job);

#endif
