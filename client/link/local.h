/* local.h - a cluster of radsubmit's own, on this machine
 *
 * The real programs, radcoord and radd, over sockets in a private folder
 * (mode 0700), in sessions of their own so that a terminal's interrupt reaches
 * radsubmit alone.  They hold the reading end of a pipe and end when it does:
 * whatever becomes of radsubmit, nothing goes on without it.
 * Thread: one.  */
#ifndef RADD_CLIENT_LOCAL_H
#define RADD_CLIENT_LOCAL_H

#include "link/target.h"

#include <stdbool.h>
#include <sys/types.h>

struct local;

/* A private folder to begin with, removed by local_stop(), or by a process of
 * its own when radsubmit is killed; so before any thread is started.  *l is to
 * be stopped whatever is returned.  RAD_ECANTCREAT, RAD_ENOMEM. */
int local_new(struct local **l, struct rad_error *err);

const char *local_folder(const struct local *l);

/* Start a coordinator and nworkers workers of nthreads each (0: the processors
 * shared evenly), and wait until the coordinator serves.  RAD_EINTERNAL when a
 * program is missing or ends, RAD_EUNAVAIL when it takes too long or *stop
 * becomes true. */
int local_start(struct local *l, int nworkers, int nthreads, const int *stop,
                struct rad_error *err);

/* Start the coordinator alone, which takes workers over the network, too: at
 * that address ("HOST:PORT"), by the key file; "" and "" for neither.  Errors
 * as of local_start(). */
int local_coordinate(struct local *l, const char *address, const char *keys,
                     const int *stop, struct rad_error *err);
/* The port that it got; 0: none. */
int local_port(const struct local *l);
/* Does it run?  And end it, so that whoever works for it ends. */
bool local_coordinated(struct local *l);
void local_end_coordinator(struct local *l);

/* A process group, of a launcher, is to be ended when radsubmit is killed; or
 * has ended, and is not. */
void local_note_group(struct local *l, pid_t group, bool ended);

/* Threads of each worker when nthreads are asked for. */
int local_threads(int nworkers, int nthreads);

/* Where its coordinator is. */
const struct target *local_target(const struct local *l);

/* Do the coordinator and a worker still run? */
bool local_alive(struct local *l);

/* How many workers still run? */
int local_workers(struct local *l);

/* End what runs, remove the folder, free. */
void local_stop(struct local *l);

#endif
