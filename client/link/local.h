/* local.h - radsubmit's own cluster on this machine
 *
 * Starts the real programs, radcoord and radd, over sockets in a private folder
 * (mode 0700).  Each leads a session of its own, so a terminal's interrupt
 * reaches radsubmit alone.  They hold the reading end of a pipe and end when
 * its writing end is closed: however radsubmit ends, they do.
 * Thread: one. */
#ifndef RADD_CLIENT_LOCAL_H
#define RADD_CLIENT_LOCAL_H

#include "compile/cargo.h"
#include "link/link.h"
#include "link/target.h"

#include <stdbool.h>
#include <sys/types.h>

struct local;

/* Make the private folder, which local_stop() removes.  A process that is
 * forked here removes it if radsubmit is killed; so call this before any thread
 * is started.  *l must be stopped whatever is returned.  RAD_ECANTCREAT,
 * RAD_ENOMEM. */
int local_new(struct local **l, struct rad_error *err);

const char *local_folder(const struct local *l);

/* Start a coordinator and nworkers workers of nthreads each (0: processors are
 * divided evenly), and wait until the coordinator serves.  RAD_EINTERNAL: a
 * program is missing or ended; RAD_EUNAVAIL: it took too long; RAD_ETEMPFAIL:
 * interrupted, which *where->wake above 0 tells. */
int local_start(struct local *l, int nworkers, int nthreads,
                const struct link_where *where, struct rad_error *err);

/* Start the coordinator alone.  It takes workers over the network, too: at
 * address ("HOST:PORT"), by the key file keys; both "" for no network.  Errors
 * as of local_start(). */
int local_coordinate(struct local *l, const char *address, const char *keys,
                     const struct link_where *where, struct rad_error *err);
/* The port that the coordinator listens at; 0: none. */
int local_port(const struct local *l);
/* Does the coordinator run?  And end it, so that its workers end. */
bool local_coordinated(struct local *l);
void local_end_coordinator(struct local *l);

/* Tell the keeper to end a launcher's process group if radsubmit is killed; or,
 * if `ended`, that it need not. */
void local_note_group(struct local *l, pid_t group, bool ended);

/* Threads of each worker if nthreads are asked for. */
int local_threads(int nworkers, int nthreads);

/* Spare copies of the cargo's large files, which lie in local_folder(): link
 * them into the folders of coordinator and workers, which find them there when
 * the cargo is offered, and check them.  Files that cannot be linked are sent.
 */
void local_share(const struct local *l, const struct cargo *cargo);

/* The coordinator's address. */
const struct target *local_target(const struct local *l);

/* 0 if the coordinator and a worker still run; else RAD_ENOMEM if a daemon had
 * no memory, or RAD_EINTERNAL. */
int local_alive(struct local *l, struct rad_error *err);

/* How many workers still run? */
int local_workers(struct local *l);

/* End all programs, remove the folder, free l. */
void local_stop(struct local *l);

#endif
