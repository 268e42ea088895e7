/* tally.h - what workers' children have counted so far
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_TALLY_H
#define DAEMON_TALLY_H

#include "desk/desk.h"

/* Handler of TALLY. */
void tally_came(struct coord *c, struct coord_worker *w, const struct msg *msg);

#endif
