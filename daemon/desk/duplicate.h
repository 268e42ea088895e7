/* duplicate.h - rows that come twice must be the same
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DUPLICATE_H
#define DAEMON_DUPLICATE_H

#include "desk/desk.h"

/* Keep a hash of rows that count, of a unit of that height. */
void duplicate_keep(struct job *job, uint32_t index, const struct msg_result *m,
                    uint32_t height);
/* Rows that do not count, but lie in their unit, came: the log says so if they
 * differ from the rows that did. */
void duplicate_check(struct coord *c, struct job *job, uint32_t index,
                     const struct msg_result *m);
/* The rows of the unit that counted do not count any more. */
void duplicate_forget(struct job_unit *u);

#endif
