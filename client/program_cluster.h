/* program_cluster.h - where radsubmit's job is rendered: at a coordinator that
 * is named, or on a cluster of radsubmit's own */
#ifndef RADD_CLIENT_PROGRAM_CLUSTER_H
#define RADD_CLIENT_PROGRAM_CLUSTER_H

#include "program.h"

/* Find out which it is.  RAD_EUSAGE: options that do not go with it. */
int program_cluster_choose(struct program *p);

/* How many workers our own cluster is to have. */
int program_cluster_workers(const struct submit_options *o);

/* Start our own cluster. */
int program_cluster_start(struct program *p);

/* Does our own cluster still run, have its workers come?  (submit.h) */
int program_cluster_alive(void *program, struct rad_error *err);
int program_cluster_gathered(void *program, int n, const char *names,
                             struct rad_error *err);

#endif
