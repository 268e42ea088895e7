/* yield.h - who gives back what, for something that comes first
 *
 * Thread: one. */
#ifndef DAEMON_YIELD_H
#define DAEMON_YIELD_H

#include "desk/desk.h"

/* Have units go back whose job is paused, whose worker is to leave, or works
 * for somebody else now. */
void yield_look(struct coord *c);

#endif
