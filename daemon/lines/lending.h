/* lending.h - columns of a busy worker's line are lent to an idle worker
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LENDING_H
#define DAEMON_LENDING_H

#include "desk/desk.h"

/* Handlers of LOAN and PAID, which workers send. */
void lending_loan(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);
void lending_paid(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);

/* Send LEND until as many loans are expected as there are idle workers. */
void lending_ask(struct coord *c, struct job *job, uint32_t idle);
/* An attempt sent PARKED.  True: what it waits for is columns that it lent. */
bool lending_parked(const struct coord *c, struct job_attempt *attempt);
/* Take back loans that are late. */
void lending_tick(struct coord *c, struct job *job);

#endif
