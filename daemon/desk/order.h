/* order.h - the coordinator's jobs in their order, and by their ids
 *
 * coord.jobs has all jobs in four ranks, each by priority and then by age:
 *
 *   begun | queued | ended | filed
 *         ^nbegun  ^nopen  ^nended ^njobs
 *
 * Thousands of jobs may be queued, and thousands filed.  What is done for each
 * message, or many times a second, goes over the jobs that are begun: they are
 * few, for a worker loads one job ahead.
 * Thread: the coordinator's loop. */
#ifndef RADD_DAEMON_ORDER_H
#define RADD_DAEMON_ORDER_H

#include <stdbool.h>

struct coord;
struct job;

enum order_rank {
    ORDER_BEGUN,  /* not over, and some worker has a part in the job */
    ORDER_QUEUED, /* not over, and no worker knows the job */
    ORDER_ENDED,  /* over; units and workers are still in memory */
    ORDER_FILED   /* over, and lightened (PLACE_FILED) */
};

/* Add a job, which has its sequence; false: memory is out. */
bool order_add(struct coord *c, struct job *job);
/* Put the job in its place after a change of its rank or priority.  A loop over
 * coord.jobs may then meet a job twice, or miss one. */
void order_move(struct coord *c, struct job *job);
/* Take the job out. */
void order_remove(struct coord *c, struct job *job);

#endif
