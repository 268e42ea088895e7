/* coord_files.h - files that users sent, or that are on their way, and which no
 * job names yet: how long they stay
 *
 * coord_files() is in coord.h.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_FILES_H
#define DAEMON_COORD_FILES_H

#include "desk/desk.h"

/* Called every tick: forget uploads that have waited upload_ms for a job, and
 * end connections whose files have made no progress for as long. */
void coord_files_tick(struct coord *c);
/* Forget which files of that age users have sent. */
void coord_files_expire(struct coord *c);

#endif
