/* duplicate.h - rows that come twice must be the same
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DUPLICATE_H
#define DAEMON_DUPLICATE_H

#include "desk/desk.h"

/* Keep hashes of rows that count, of a unit that has `height` rows. */
void duplicate_keep(struct job *job, uint32_t index, const struct msg_result *m,
                    uint32_t height);
/* Compare rows that do not count, but lie in their unit, with the hashes of the
 * rows that do; log a difference. */
void duplicate_check(struct coord *c, struct job *job, uint32_t index,
                     const struct msg_result *m);
/* Forget the hashes: the unit's rows do not count any more. */
void duplicate_forget(struct job_unit *u);

#endif
