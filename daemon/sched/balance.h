/* balance.h - idle workers get lines of busy workers, or twins of their units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_BALANCE_H
#define DAEMON_BALANCE_H

#include "desk/desk.h"

/* Handler of GAVE. */
void balance_gave(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);

/* Find work for idle workers: ask busy ones for lines or columns. */
void balance_run(struct coord *c);
/* Note which workers hang and how many units are late. */
void balance_look(struct coord *c);
/* Give a worker a late unit of others as a twin; false: there is none. */
bool balance_give_twin(struct coord *c, struct job *job, uint32_t index);

#endif
