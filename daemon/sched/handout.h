/* handout.h - a unit goes out to a worker
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_HANDOUT_H
#define DAEMON_HANDOUT_H

#include "desk/desk.h"

/* Give a worker a unit; as a twin if other workers have it. */
void handout_unit(struct coord *c, struct job *job, uint32_t index,
                  uint32_t unit);

#endif
