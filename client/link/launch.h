/* launch.h - workers that srun, mpirun or ssh start, for one job
 *
 * For radsubmit --launch=COMMAND.  The coordinator is one of local.h that
 * listens on the network.  sh runs COMMAND with radd's command line behind it:
 * once, or once for each worker if COMMAND has "%d".  A key is made for this
 * job.  Its line (key.h) is in the variable RADD_LAUNCH_KEY of COMMAND's
 * environment, which srun and mpirun pass on, and on its standard input, which
 * ssh passes on.  Workers end when the coordinator does.  Processes that
 * COMMAND leaves behind are ended by launch_stop() or, if radsubmit is killed,
 * by local.h's keeper.
 * Thread: one. */
#ifndef RADD_CLIENT_LAUNCH_H
#define RADD_CLIENT_LAUNCH_H

#include "link/local.h"

struct launch_order {
    const char *command;
    const char *address; /* HOST[:PORT] that workers dial; NULL: chosen here */
    int workers;         /* least number before the job begins */
    int threads;         /* of each worker; 0: the worker chooses */
    double wait_s;       /* most time for workers to come */
};

struct launch;

/* COMMAND for the worker of that number: "%d" becomes the number, "%%" is "%".
 * To be freed; NULL: memory is out. */
char *launch_command(const char *command, int number);
/* Is COMMAND run once for each worker? */
bool launch_each(const char *command);
/* The address that workers dial, HOST:PORT with port 0 if none is given, and
 * the address to listen at for it.  RAD_EUSAGE. */
#define LAUNCH_ADDRESS 300
int launch_address(const char *given, char dial[LAUNCH_ADDRESS],
                   char listen[LAUNCH_ADDRESS], struct rad_error *err);

/* Start the coordinator and the launchers.  *l must be stopped whatever is
 * returned.  Errors of local_start(), RAD_EUSAGE, RAD_ENOMEM. */
int launch_start(struct launch **l, struct local *local,
                 const struct launch_order *order,
                 const struct link_where *where, struct rad_error *err);

/* Tell that n workers are connected; names lists them ("ws1-812, ws2-97").
 * Returns 1 if the job can begin: there are enough, and no more are coming; 0
 * to wait; RAD_EUNAVAIL if the time is over or a launcher has failed.  *news:
 * the user should hear of the number. */
int launch_gathered(struct launch *l, int n, const char *names, bool *news,
                    struct rad_error *err);

/* Tell that n workers take part in the job. */
void launch_note_workers(struct launch *l, int n);
/* 0; or RAD_EUNAVAIL if there is no worker, and none will come. */
int launch_alive(struct launch *l, struct rad_error *err);

/* End the coordinator, wait for the launchers, kill those that do not end, and
 * free l. */
void launch_stop(struct launch *l);

#endif
