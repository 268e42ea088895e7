/* statecheck.h - is a coordinator's state folder what it should be?
 *
 * The same is looked at as when radcoord starts, but to the end and without
 * changing anything: the database, what it says of jobs and units, their files.
 * Thread: any, one at a time. */
#ifndef DAEMON_STATECHECK_H
#define DAEMON_STATECHECK_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

struct statecheck {
    uint32_t jobs;     /* that are known, and not being forgotten */
    uint32_t open;     /* of these not over, and not cancelled on a full disk */
    uint32_t problems; /* that were told: damage */
    uint32_t denied;   /* likewise: what we may not read, so nobody knows, and
                        * what no radcoord takes for others' rights to it */
    uint32_t redo;     /* units whose rows are other than they were: they will
                        * be made again */
};

/* tell is called for each problem, and each unit that is to be made again.
 * RAD_ENOINPUT when there is no such folder, RAD_ETEMPFAIL when a coordinator
 * uses it, RAD_ENOMEM. */
int statecheck_run(const char *dir, struct statecheck *out,
                   void (*tell)(void *arg, bool problem, const char *text),
                   void *arg, struct rad_error *err);

#endif
