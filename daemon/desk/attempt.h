/* attempt.h - attempts: which worker has which units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ATTEMPT_H
#define DAEMON_ATTEMPT_H

#include "desk/desk.h"

/* Begin an attempt at a unit; NULL: it has too many, or memory is out. */
struct job_go *attempt_add(struct coord *c, struct job *job, uint32_t index,
                           uint32_t unit, uint32_t attempt);
/* Begin the attempt again that led a unit which waits since it was lost: its
 * worker is at it still, or sent rows of it.  False: memory is out. */
bool attempt_revive(struct coord *c, struct job *job, uint32_t index,
                    uint32_t unit);
/* Change the attempt's state, and the worker's counts of attempts. */
void attempt_step(struct coord *c, struct job *job, uint32_t unit,
                  struct job_go *go, enum go_state to);
/* The attempt has fewer lines than before: count them again. */
void attempt_shrunk(struct job *job, uint32_t unit, struct job_go *go);
/* Cut a unit after `height` rows, which are all that the attempt will do: the
 * rest becomes a new unit.  False: no line ends there. */
bool attempt_shrink(struct coord *c, struct job *job, uint32_t unit,
                    struct job_go *go, uint32_t height);
/* End the attempt and free it; pointers to other attempts at the unit become
 * invalid. */
void attempt_release(struct coord *c, struct job *job, uint32_t unit,
                     struct job_go *go);
/* The attempt has made the base line above its unit, or will not: if it was to,
 * the unit above may go to other workers again. */
void attempt_top_made(struct coord *c, struct job *job, uint32_t unit,
                      struct job_go *go);
/* Send BACK: columns that a worker lent are its own again. */
void attempt_send_back(struct coord *c, const struct coord_worker *to,
                       const struct msg_back *back);
/* Bring coord_worker.priority up to date. */
void attempt_rate(const struct coord *c, struct coord_worker *w);

/* Forget that rows of the unit came: they do not count any more. */
void attempt_forget_rows(struct job *job, uint32_t unit);

#endif
