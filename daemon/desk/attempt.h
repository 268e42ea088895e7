/* attempt.h - attempts: which worker has which units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ATTEMPT_H
#define DAEMON_ATTEMPT_H

#include "desk/desk.h"

/* Begin an attempt at a unit by the job's worker of this index; NULL: the unit
 * has too many attempts, or memory is out. */
struct job_go *attempt_add(struct coord *c, struct job *job, uint32_t index,
                           uint32_t unit, uint32_t attempt);
/* Begin again the attempt that led a unit before the unit was lost: its worker
 * still works on the unit, or sent rows of it.  False: memory is out. */
bool attempt_revive(struct coord *c, struct job *job, uint32_t index,
                    uint32_t unit);
/* Change the attempt's state, and the worker's counts of attempts. */
void attempt_step(struct coord *c, struct job *job, struct job_go *go,
                  enum go_state to);
/* The worker makes tiles for the job from now on, or with NULL for none: its
 * threads count for the job's payer between tiles, too, until it gets a unit,
 * or tiles of another job. */
void attempt_fill(struct coord_worker *w, struct job *job);
/* The worker estimates this chunk of the job's areas from now on, counted from
 * 1; 0: none.  Its threads count as those of a worker that makes tiles do. */
void attempt_survey(struct job *job, uint32_t index, uint32_t chunk);
/* Cut a unit after `height` rows, which are all that the attempt will do: the
 * rest becomes a new unit.  False: no line ends after so many rows, or more
 * rows have come. */
bool attempt_shrink(struct coord *c, struct job *job, struct job_go *go,
                    uint32_t height);
/* End the attempt and free it; pointers to other attempts at the unit become
 * invalid. */
void attempt_release(struct coord *c, struct job *job, struct job_go *go);
/* Note that the attempt has made the base line above its unit, or will not make
 * it: if the attempt was to, the unit above may go to other workers again. */
void attempt_top_made(struct coord *c, struct job *job, struct job_go *go);
/* Send BACK to a worker: columns that it lent are its own again. */
void attempt_send_back(struct coord *c, const struct coord_worker *to,
                       const struct msg_back *back);
/* Has the worker attempts of the job in flight? */
bool attempt_has_any(const struct job *job, const struct coord_worker *w);
/* The number of workers that are at the job: each loads it or is ready for it,
 * and does not rest, or work for jobs of a higher priority alone. */
uint32_t attempt_workers(const struct job *job);
/* Bring the worker's coord_worker.priority up to date. */
void attempt_rate(const struct coord *c, struct coord_worker *w);

/* Forget that rows of the unit came: these rows do not count any more. */
void attempt_forget_rows(struct job *job, uint32_t unit);

#endif
