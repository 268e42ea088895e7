/* sched.h - who works on what: the part of the coordinator that hands out
 *
 *   sched.c       which worker gets which unit next; messages of workers
 *   handout.c     a unit goes out
 *   result.c      rows that come, units that are done
 *   loss.c        workers and children that go
 *   balance.c     giving away and doubling, for a worker that has nothing
 *   yield.c       giving back, for something that comes first
 *   survey.c      estimates, before the first unit
 *   sched_tick.c  what all of these do as time passes
 * Thread: one. */
#ifndef DAEMON_SCHED_H
#define DAEMON_SCHED_H

#include "desk/desk.h"

/* Give units, and jobs to load, to every worker that has room. */
void sched_run(struct coord *c);

/* Time has passed. */
void sched_tick(struct coord *c);

/* Messages of workers. */
void sched_ready(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);
void sched_tally(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);

/* An admin drained a worker, or had enough of that: others may take what was to
 * be its part of a job, or may not. */
void sched_drained(struct coord *c, struct coord_worker *w);

/* Take the units of a job back and tell its workers that it is over. */
void sched_job_over(struct coord *c, struct job *job);

/* One unit for the worker; false: it gets none now. */
bool sched_serve(struct coord *c, struct coord_worker *w);

#endif
