/* balance.h - lines of a busy worker, or a twin, for an idle worker
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_BALANCE_H
#define DAEMON_BALANCE_H

#include "desk/desk.h"

/* A message of a worker. */
void balance_gave(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);

/* Find work for idle workers: ask busy ones for lines or columns. */
void balance_run(struct coord *c);
/* See which workers hang, and which units are late. */
void balance_look(struct coord *c);
/* A late unit for a worker, as a twin; false: there is none. */
bool balance_give_twin(struct coord *c, struct job *job, uint32_t index);

#endif
