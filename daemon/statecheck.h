/* statecheck.h - is a coordinator's state folder what it should be?
 *
 * The same is looked at as when radcoord starts, but to the end and without
 * changing anything: the database, what it says of jobs and units, their files.
 * Thread: any, one at a time. */
#ifndef DAEMON_STATECHECK_H
#define DAEMON_STATECHECK_H

#include "base/error.h"

#include <stdint.h>

struct statecheck {
    uint32_t jobs;     /* that are known */
    uint32_t open;     /* of these not over */
    uint32_t problems; /* that were told */
};

/* tell is called for each problem.  RAD_ENOINPUT when there is no such folder,
 * RAD_ETEMPFAIL when a coordinator uses it, RAD_ENOMEM. */
int statecheck_run(const char *dir, struct statecheck *out,
                   void (*tell)(void *arg, const char *problem), void *arg,
                   struct rad_error *err);

#endif
