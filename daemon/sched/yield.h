/* yield.h - units that workers give back, for work that comes first
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_YIELD_H
#define DAEMON_YIELD_H

#include "desk/desk.h"

/* Have units go back whose job is paused, or whose worker is to leave or is to
 * work for another owner or a job of higher priority. */
void yield_look(struct coord *c);

#endif
