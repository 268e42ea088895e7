/* launched.h - a worker that a launcher started for one job
 *
 * radsubmit --launch has srun, mpirun or ssh start "radd --launched".  Such a
 * worker reads no key file and needs no settings: it gets the job's key, which
 * stands in no argument; it makes itself a unique name and a folder for the
 * scene's files, which it removes at its end.  It ends when its coordinator
 * does.
 * Thread: main's. */
#ifndef RADD_DAEMON_LAUNCHED_H
#define RADD_DAEMON_LAUNCHED_H

#include "net/dial.h"

#include <stdbool.h>
#include <stdint.h>

/* environment variable with a line of a key file; wiped once it is read, for
 * /proc shows it */
#define LAUNCHED_VARIABLE "RADD_LAUNCH_KEY"
/* after so long without a coordinator the job counts as over */
#define LAUNCHED_PATIENCE_MS 30000

struct launched {
    char folder[128]; /* "": none was made */
    bool welcome;     /* the coordinator was connected at some time */
    uint64_t heard_ms;
};

/* Read the key from LAUNCHED_VARIABLE or, if that is not set, from the first
 * line of standard input; a launcher forwards one of these.  RAD_ENOINPUT:
 * neither came within LAUNCHED_PATIENCE_MS; RAD_ECONFIG: the line is not one
 * valid key. */
int launched_key(struct dial_key *key, struct rad_error *err);

/* Write HOST-PID into name, of that size. */
void launched_name(char *name, size_t size);

/* Make the folder in TMPDIR or /tmp; the store will lock it.  Also removes
 * folders of workers that were killed.  RAD_ECANTCREAT. */
int launched_begin(struct launched *l, struct rad_error *err);

/* Remove the folder.  May be called again, for files that were written since.
 */
void launched_end(struct launched *l);

/* Called as time passes; connected: to the coordinator.  True: the coordinator
 * has been away for longer than LAUNCHED_PATIENCE_MS. */
bool launched_over(struct launched *l, uint64_t now_ms, bool connected);

#endif
