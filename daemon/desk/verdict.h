/* verdict.h - note that a connection is to end, or that a job is over
 *
 * A verdict is noted where its reason is found.  front/coord.c carries it out
 * at the end of the event, so no job, unit, attempt or connection is freed
 * under a function that works on it.  job_over() holds for a job from its
 * verdict on; its workers, its files and the users that wait for it are told at
 * the end of the event.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_VERDICT_H
#define DAEMON_VERDICT_H

#include "desk/desk.h"

/* Note that a connection is to be closed: it broke the rules, or there is no
 * room for it; why (copied) goes to the log. */
void verdict_break(struct coord *c, uint64_t conn, const char *why);

/* Note that a connection is to be closed whose other side knows that it ends.
 */
void verdict_part(struct coord *c, uint64_t conn, const char *why);

/* Note that a job is over: state JOB_DONE, or JOB_FAILED with a status of
 * sysexits.h, or JOB_CANCELLED; text (copied) may be NULL.  Ignored if the job
 * is over already. */
void verdict_job(struct coord *c, struct job *job, enum job_state state,
                 int status, const char *text);

#endif
