/* launched.h - a worker that a launcher started for one job
 *
 * radsubmit --launch has srun, mpirun or ssh start "radd --launched".  Such a
 * worker reads no key file and needs no settings.  It gets the job's key, but
 * not as an argument, which other users could see.  It makes itself a unique
 * name, and a folder for the scene's files, which it removes at its end.  It
 * ends when its coordinator ends.
 * Thread: main's. */
#ifndef RADD_DAEMON_LAUNCHED_H
#define RADD_DAEMON_LAUNCHED_H

#include "net/dial.h"

#include <stdbool.h>
#include <stdint.h>

/* Environment variable with a line of a key file; wiped once it is read, for
 * /proc shows the environment. */
#define LAUNCHED_VARIABLE "RADD_LAUNCH_KEY"
/* The job counts as over after so long without a coordinator. */
#define LAUNCHED_PATIENCE_MS 30000

struct launched {
    char folder[128];  /* "": none was made */
    bool welcome;      /* the coordinator has been connected */
    uint64_t heard_ms; /* when the coordinator was last connected, or the worker
                        * began; 0: launched_over() was not called yet */
};

/* Read the key from LAUNCHED_VARIABLE or, if that is not set, from the first
 * line of standard input: a launcher forwards the one or the other.
 * RAD_ENOINPUT: neither came within LAUNCHED_PATIENCE_MS; RAD_ECONFIG: the text
 * is not exactly one valid key. */
int launched_key(struct dial_key *key, struct rad_error *err);

/* Write HOST-PID into name, of that size. */
void launched_name(char *name, size_t size);

/* Make the folder in TMPDIR or /tmp; the store will lock it.  Also removes
 * folders of workers that were killed.  RAD_ECANTCREAT. */
int launched_begin(struct launched *l, struct rad_error *err);

/* Remove the folder.  May be called again, to remove files that were written
 * since. */
void launched_end(struct launched *l);

/* Has the coordinator been away for LAUNCHED_PATIENCE_MS?  Call this as time
 * passes; connected: the worker is connected to the coordinator. */
bool launched_over(struct launched *l, uint64_t now_ms, bool connected);

#endif
