/* lead.h - progress of a job's passes, which come before its units
 *
 * The passes' share of the job's work is a guess (passes/passcost.h).  In a job
 * with a goal the number of stages is not known: the first stage counts as half
 * of the passes' work, the next as half of the rest, and so on.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LEAD_H
#define DAEMON_LEAD_H

#include "desk/desk.h"
#include "passes/passplan.h"

/* The job has passes, for pictures of these sizes: guess the passes' share of
 * its work. */
void lead_begin(struct job *job, const struct rad_pass_size *size);

/* Note the share of the stage's passes that is done, 0 to 1; `all`: no further
 * stage follows. */
void lead_note(struct job *job, double done, bool all);

/* After a restart: note that all passes are done in a job of which units went
 * out. */
void lead_restore(struct job *job);

#endif
