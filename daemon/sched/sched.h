/* sched.h - which worker gets which unit
 *
 *   sched.c       which worker gets which unit next
 *   turn.c        whose job is next for a worker
 *   ready.c       a worker has loaded a job
 *   handout.c     a unit goes out to a worker
 *   result.c      rows come, units are done
 *   tally.c       what workers' children have counted
 *   loss.c        workers and children are lost
 *   balance.c     idle workers get lines of others, and twins
 *   yield.c       units are given back for work that comes first
 *   survey.c      costs are estimated before the first unit
 *   sched_tick.c  calls the others as time passes
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SCHED_H
#define DAEMON_SCHED_H

#include "desk/desk.h"

/* Give units, and jobs to load, to all workers that have room; or to one
 * worker, if nothing has changed for the others. */
void sched_run(struct coord *c);
void sched_run_for(struct coord *c, struct coord_worker *w);

/* Called every tick. */
void sched_tick(struct coord *c);

/* An admin drained or undrained a worker: other workers may take its share of a
 * job's units, or no longer. */
void sched_drained(struct coord *c, struct coord_worker *w);

/* End all attempts of a job that is over, and tell its workers. */
void sched_job_over(struct coord *c, struct job *job);

/* Give the worker one unit, tile or chunk of areas; false: there is none for it
 * now. */
bool sched_serve(struct coord *c, struct coord_worker *w);

#endif
