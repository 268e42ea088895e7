/* duplicate.h - rows that come twice must be the same
 *
 * Thread: one. */
#ifndef DAEMON_DUPLICATE_H
#define DAEMON_DUPLICATE_H

#include "desk/desk.h"

/* Rows of a unit of that height that count. */
void duplicate_keep(struct job *job, uint32_t index, const struct msg_result *m,
                    uint32_t height);
/* Rows that do not, but lie in their unit: are they those that did? */
void duplicate_check(struct coord *c, struct job *job, uint32_t index,
                     const struct msg_result *m);
/* What counted does not any more. */
void duplicate_forget(struct job_unit *u);

#endif
