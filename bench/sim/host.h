/* host.h - a worker of a simulated cluster: its radd and its job's child
 *
 * host.c is what it does; the other host_*.c are the parts of that.
 * Thread: one. */
#ifndef SIM_HOST_H
#define SIM_HOST_H

#include "cluster.h"

void host_init(struct cluster *c, struct host *h, int number, double speed);
void host_release(struct host *h);
size_t host_size(void);
struct host *host_at(const struct cluster *c, int i);

/* Its radd starts, and calls the coordinator. */
void host_start(struct cluster *c, struct host *h);

/* Time has passed; to be called every 100 ms. */
void host_tick(struct cluster *c, struct host *h);

/* It dies, and is there again after spec->back_us. */
void host_fail(struct cluster *c, struct host *h);

/* A message of the coordinator came. */
void host_message(struct cluster *c, struct host *h, const struct msg *m);
/* The job is over: whatever it does ends. */
void host_over(struct host *h);
/* What it counted so far into the result. */
void host_count(const struct host *h, struct cluster_result *out);

#endif
