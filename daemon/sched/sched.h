/* sched.h - which worker gets which unit: the part of the coordinator that
 * hands out
 *
 *   sched.c       which worker gets which unit next; messages of workers
 *   handout.c     a unit goes out
 *   result.c      rows that come, units that are done
 *   loss.c        workers and children that go
 *   balance.c     lines given away, and twins, for idle workers
 *   yield.c       units given back, for work that comes first
 *   survey.c      estimates of cost, before the first unit
 *   sched_tick.c  calls the others as time passes
 * Thread: the coordinator's loop. */
#ifndef DAEMON_SCHED_H
#define DAEMON_SCHED_H

#include "desk/desk.h"

/* Give units, and jobs to load, to every worker that has room; to that one,
 * where nothing has changed for others. */
void sched_run(struct coord *c);
void sched_run_for(struct coord *c, struct coord_worker *w);

/* Time has passed. */
void sched_tick(struct coord *c);

/* Messages of workers. */
void sched_ready(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);
void sched_tally(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);

/* An admin drained a worker, or undrained it: other workers may take its share
 * of the units of a job from then on, or no longer. */
void sched_drained(struct coord *c, struct coord_worker *w);

/* Take the units of a job back and tell its workers that it is over. */
void sched_job_over(struct coord *c, struct job *job);

/* Hand the worker one unit; false: there is none for it now. */
bool sched_serve(struct coord *c, struct coord_worker *w);

#endif
