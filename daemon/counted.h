/* faults.h - what the renderer counts of functions without a value, as messages
 * tell it */
#ifndef RADD_DAEMON_FAULTS_H
#define RADD_DAEMON_FAULTS_H

#include "message.h"
#include "shade/job.h"

_Static_assert(RAD_MAX_FAULTS == MSG_FAULTS, "one for each");

static inline void
faults_add(struct msg_fault to[MSG_FAULTS],
           const struct rad_fault from[RAD_MAX_FAULTS])
{
    struct msg_fault more[MSG_FAULTS];

    for (int i = 0; i < MSG_FAULTS; i++)
        more[i] = (struct msg_fault){ (uint32_t)from[i].object, from[i].count };
    msg_faults_add(to, more);
}

#endif
