/* duplicate.h - rows that come twice must be the same
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DUPLICATE_H
#define DAEMON_DUPLICATE_H

#include "desk/desk.h"

/* Keep hashes of rows that count; their unit has `height` rows.  No hashes are
 * kept if the job is not exact or memory is out. */
void duplicate_keep(struct job *job, uint32_t index, const struct msg_result *m,
                    uint32_t height);
/* Compare rows that do not count with the hashes of the unit's rows that count;
 * log the first difference.  The rows of *m lie in the unit. */
void duplicate_check(struct coord *c, struct job *job, uint32_t index,
                     const struct msg_result *m);
/* Forget the hashes: the unit's rows do not count any more. */
void duplicate_forget(struct job_unit *u);

#endif
