/* yield.h - workers give units back for work that comes first
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_YIELD_H
#define DAEMON_YIELD_H

#include "desk/desk.h"

/* Called every tick: have units given back whose job is paused, or whose worker
 * is to leave, or to work for another owner or a job of higher priority. */
void yield_look(struct coord *c);

#endif
