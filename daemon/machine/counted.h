/* counted.h - what the renderer counts, as messages tell it */
#ifndef RADD_DAEMON_COUNTED_H
#define RADD_DAEMON_COUNTED_H

#include "proto/message.h"
#include "trace/job.h"

/* Add the counts c of work that took cpu_s of processor time to *sum. */
void counted_add(struct msg_counts *sum, const struct rad_counts *c,
                 double cpu_s);

#endif
