/* speed.h - how fast workers are, and how long a unit will take
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SPEED_H
#define DAEMON_SPEED_H

#include "desk/desk.h"

/* Bring a worker's work_ms up to date; call it before its attempts change. */
void speed_touch(const struct coord *c, struct job_part *part);
/* Count the unit's cost as worked off by the attempt's worker, once for each
 * attempt. */
void speed_finished(struct job *job, struct job_attempt *attempt);
/* Compute the speeds of a job's workers, and the job's pace. */
void speed_measure(const struct coord *c, struct job *job);
/* The job is over: remember for other jobs how fast its workers were. */
void speed_keep(const struct coord *c, struct job *job);
/* The cost that a worker of the job works off in ms milliseconds. */
double speed_cost(const struct job *job, uint32_t index, double ms);
/* Note how long a unit took, from when it went out until it was done. */
void speed_took(struct job *job, uint64_t ms);
/* The median of the times that the last JOB_DURATIONS units took [ms]; 0: no
 * unit was done yet. */
uint32_t speed_median_ms(const struct job *job);
/* How long an attempt will still need [ms]. */
double speed_left_ms(const struct coord *c, const struct job *job,
                     const struct job_attempt *attempt);
/* All costs are known: set the workers' shares of a static partition, so that
 * units may go out. */
void speed_share(struct coord *c, struct job *job);

#endif
