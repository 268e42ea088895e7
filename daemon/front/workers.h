/* workers.h - messages of workers: which function handles each
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_WORKERS_H
#define DAEMON_WORKERS_H

#include "desk/desk.h"

/* Handle a message that a worker may send (proto/message.def). */
void workers_handle(struct coord *c, struct coord_worker *w,
                    const struct msg *m);

#endif
