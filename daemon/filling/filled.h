/* filled.h - how much of a job's ambient cache is filled
 *
 * The passes' share of the job's work is a guess (passes/passcost.h).  In a job
 * with a goal the number of stages is not known: the first stage counts as half
 * of the passes' work, the next as half of the rest, and so on.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_FILLED_H
#define DAEMON_FILLED_H

#include "desk/desk.h"
#include "passes/passplan.h"

/* The job has passes, for pictures of these sizes: guess the passes' share of
 * its work. */
void filled_begin(struct job *job, const struct rad_pass_size *size);

/* Note the share of the stage's passes that is done, 0 to 1; `all`: no further
 * stage follows. */
void filled_note(struct job *job, double done, bool all);

/* After a restart: note that all passes are done in a job of which units went
 * out. */
void filled_restore(struct job *job);

#endif
