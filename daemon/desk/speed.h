/* speed.h - how fast workers are, and how long a unit will take
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SPEED_H
#define DAEMON_SPEED_H

#include "desk/desk.h"

/* Bring a worker's times up to date; before its units change. */
void speed_touch(const struct coord *c, struct job_worker *jw);
/* The worker of an attempt has worked off the cost of its unit; counts once. */
void speed_finished(struct job *job, uint32_t unit, struct job_go *go);
/* Speeds of all workers of a job, and its pace. */
void speed_measure(const struct coord *c, struct job *job);
/* The job is over: remember how fast its workers were. */
void speed_keep(const struct coord *c, struct job *job);
/* The cost that a worker of the job works off in that time. */
double speed_cost(const struct job *job, uint32_t index, double ms);
/* A unit was done so long after it went out. */
void speed_took(struct job *job, uint64_t ms);
/* The median of these times, of the last JOB_DURATIONS units [ms]; 0 before any
 * unit was done. */
uint32_t speed_median_ms(const struct job *job);
/* How long a holder will need yet [ms]. */
double speed_left_ms(const struct coord *c, const struct job *job,
                     uint32_t unit, const struct job_go *go);
/* All costs are known: units may go out. */
void speed_share(struct coord *c, struct job *job);

#endif
