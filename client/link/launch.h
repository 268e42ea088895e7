/* launch.h - workers that srun, mpirun or ssh start, for one job
 *
 * radsubmit --launch=COMMAND.  The coordinator is local.h's and listens on the
 * network; COMMAND is run by sh with radd's command line behind it, once, or
 * once for each worker where it has "%d".  The key, made for this job, is in
 * the variable RADD_LAUNCH_KEY of COMMAND's environment and on its standard
 * input, a line of keyfile.h: srun and mpirun hand on the former, ssh the
 * latter.  Workers end when the coordinator has; what COMMAND left behind is
 * ended, by launch_stop() or, when radsubmit was killed, by local.h's keeper.
 * Thread: one.  */
#ifndef RADD_CLIENT_LAUNCH_H
#define RADD_CLIENT_LAUNCH_H

#include "link/local.h"

struct launch_order {
    const char *command;
    const char *address; /* HOST[:PORT] where workers dial; NULL: chosen */
    int workers;         /* at least, to begin with */
    int threads;         /* of each; 0: theirs to choose */
    double wait_s;       /* for workers */
};

struct launch;

/* COMMAND for worker `number`: "%d" becomes the number, "%%" is "%".  To be
 * freed; NULL when memory is out. */
char *launch_command(const char *command, int number);
/* Is COMMAND run once for each worker? */
bool launch_each(const char *command);
/* The address that workers dial, HOST:PORT with port 0 where none is given,
 * and where the coordinator listens for that.  RAD_EUSAGE. */
#define LAUNCH_ADDRESS 300
int launch_address(const char *given, char dial[LAUNCH_ADDRESS],
                   char listen[LAUNCH_ADDRESS], struct rad_error *err);

/* Start coordinator and launchers; *l is to be stopped whatever is returned.
 * Errors of local_start(), RAD_EUSAGE, RAD_ENOMEM. */
int launch_start(struct launch **l, struct local *local,
                 const struct launch_order *order, const int *stop,
                 struct rad_error *err);

/* So many workers are there now, called names ("ws1-812, ws2-97"): 1 when that
 * is enough and no more come, 0 to wait; RAD_EUNAVAIL when the time is over or
 * a launcher has failed.  *news: it is worth saying. */
int launch_gathered(struct launch *l, int n, const char *names, bool *news,
                    struct rad_error *err);

/* So many take part in the job. */
void launch_note_workers(struct launch *l, int n);
/* 0, or RAD_EUNAVAIL when no worker is left and none will come. */
int launch_alive(struct launch *l, struct rad_error *err);

/* End the coordinator, wait for the launchers, end what does not; free. */
void launch_stop(struct launch *l);

#endif
