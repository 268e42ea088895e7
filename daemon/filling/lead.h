/* lead.h - how far a job is before its units are: its passes
 *
 * What part of a job's work they are is a guess (passes/passcost.h).  With a
 * goal nobody knows how many stages there will be: the first counts as half of
 * all, the next as half of what is left, and so on.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LEAD_H
#define DAEMON_LEAD_H

#include "desk/desk.h"
#include "passes/passplan.h"

/* The job has passes, for pictures of these sizes. */
void lead_begin(struct job *job, const struct rad_pass_size *size);

/* So much of its stage's passes is done, 0 to 1, or of all of them. */
void lead_note(struct job *job, double done, bool all);

/* The job goes on after a restart: it has units only if its passes were all
 * closed. */
void lead_restore(struct job *job);

#endif
