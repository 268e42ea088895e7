/* kept.h - records of passes that an earlier life of the coordinator closed
 *
 * They wait in the job until its first worker is ready (sched/passes.c).
 * Thread: one. */
#ifndef DAEMON_KEPT_H
#define DAEMON_KEPT_H

#include "machine/saved.h"

/* Zeroed: there are none. */
struct kept_passes {
    uint32_t n;
    struct saved_pass *pass; /* each malloc'd, as the list is */
};

/* Copy what the store kept of a job's; false: memory is out. */
bool kept_copy(struct kept_passes *k, const struct saved_job *s);
void kept_drop(struct kept_passes *k);

#endif
