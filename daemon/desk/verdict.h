/* verdict.h - a connection is to end, a job is over
 *
 * A verdict is noted where the reason for it is found and carried out once, at
 * the end of the event (front/coord.c): so no job, unit, attempt or connection
 * goes away under a function that is at work on it.  job_over() is true of a
 * job from its verdict on; its workers, its files and the users that wait for
 * it hear of its end at the end of the event.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_VERDICT_H
#define DAEMON_VERDICT_H

#include "desk/desk.h"

/* Close a connection that broke the rules, or that there is no room for; why
 * (copied) goes to the log. */
void verdict_break(struct coord *c, uint64_t conn, const char *why);

/* Close a connection of which both sides know that it ends. */
void verdict_part(struct coord *c, uint64_t conn, const char *why);

/* End a job, unless it is over; text (copied) may be NULL. */
void verdict_job(struct coord *c, struct job *job, enum job_state state,
                 int status, const char *text);

#endif
