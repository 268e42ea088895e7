/* verdict.h - a connection is to end, a job is over
 *
 * A verdict is noted where the reason for it is found and carried out once, at
 * the end of the event (queue/coord_conn.c, coord_job.c): so no job, unit,
 * attempt or connection goes away under whoever is at work on it.  A job is
 * over from the moment of its verdict, which job_over() says; what follows from
 * that for workers, files and those who wait comes with the end of the event.
 * Thread: one. */
#ifndef DAEMON_VERDICT_H
#define DAEMON_VERDICT_H

#include "desk/desk.h"

/* Close a connection that broke the rules.  why outlives the event. */
void verdict_break(struct coord *c, uint64_t conn, const char *why);

/* Close a connection of which both sides know that it ends. */
void verdict_part(struct coord *c, uint64_t conn, const char *why);

/* End a job, unless it is over; text (copied) may be NULL. */
void verdict_job(struct coord *c, struct job *job, enum job_state state,
                 int status, const char *text);

#endif
