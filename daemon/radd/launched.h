/* launched.h - a worker that a launcher started for one job
 *
 * radsubmit --launch has srun, mpirun or ssh start "radd --launched".  What is
 * otherwise in radd.conf such a worker has of its own: the job's key, which is
 * in no argument; a name unlike all others; a folder for the scene's files,
 * gone with it.  It ends when its coordinator has.
 * Thread: main's. */
#ifndef RADD_DAEMON_LAUNCHED_H
#define RADD_DAEMON_LAUNCHED_H

#include "net/dial.h"

#include <stdbool.h>
#include <stdint.h>

/* holds a line of a key file; wiped where /proc would show it */
#define LAUNCHED_VARIABLE "RADD_LAUNCH_KEY"
/* so long without a coordinator and the job is taken to be over */
#define LAUNCHED_PATIENCE_MS 30000

struct launched {
    char folder[128]; /* "": none was made */
    bool welcome;     /* the coordinator was there */
    uint64_t heard_ms;
};

/* The key of the variable or, where it is not set, of standard input's first
 * line, as a launcher forwards one of them.  RAD_ENOINPUT where neither has
 * one within the patience, RAD_ECONFIG for a line that is none. */
int launched_key(struct dial_key *key, struct rad_error *err);

/* HOST-PID into name of that size. */
void launched_name(char *name, size_t size);

/* Make the folder, below TMPDIR or /tmp, for a store that locks it, and remove
 * those whose workers were killed.  RAD_ECANTCREAT. */
int launched_begin(struct launched *l, struct rad_error *err);

/* Remove the folder; again, for what has come into it since. */
void launched_end(struct launched *l);

/* Time passes; connected: to the coordinator.  True when it is gone for good:
 * for longer than the patience. */
bool launched_over(struct launched *l, uint64_t now_ms, bool connected);

#endif
