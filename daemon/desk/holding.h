/* holding.h - who holds what: attempts at units begin, change and end; a worker
 * without units makes tiles, or estimates areas, of one job
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_HOLDING_H
#define DAEMON_HOLDING_H

#include "desk/desk.h"

/* Begin an attempt at a unit by the job's worker of this index; NULL: the unit
 * has too many attempts, or memory is out. */
struct job_attempt *holding_begin(struct coord *c, struct job *job,
                                  uint32_t index, uint32_t unit,
                                  uint32_t number);
/* Begin again the attempt that led a unit before the unit was lost: its worker
 * still works on the unit, or sent rows of it.  False: memory is out. */
bool holding_revive(struct coord *c, struct job *job, uint32_t index,
                    uint32_t unit);
/* Change the attempt's state, and the worker's counts of attempts. */
void holding_step(struct coord *c, struct job *job, struct job_attempt *attempt,
                  enum attempt_state to);
/* The worker makes tiles for the job from now on, or with NULL for none: its
 * threads count for the job's payer between tiles, too, until it gets a unit,
 * or tiles of another job. */
void holding_fill(struct coord_worker *w, struct job *job);
/* The worker estimates this chunk of the job's areas from now on, counted from
 * 1; 0: none.  Its threads count as those of a worker that makes tiles do. */
void holding_survey(struct job *job, uint32_t index, uint32_t chunk);
/* Cut a unit after `height` rows, which are all that the attempt will do: the
 * rest becomes a new unit.  False: no line ends after so many rows, or more
 * rows have come. */
bool holding_shrink(struct coord *c, struct job *job,
                    struct job_attempt *attempt, uint32_t height);
/* End the attempt and free it; pointers to other attempts at the unit become
 * invalid. */
void holding_end(struct coord *c, struct job *job, struct job_attempt *attempt);
/* Note that the attempt has made the base line above its unit, or will not make
 * it: if the attempt was to, the unit above may go to other workers again. */
void holding_top_made(struct coord *c, struct job *job,
                      struct job_attempt *attempt);
/* Send BACK to a worker: columns that it lent are its own again. */
void holding_send_back(struct coord *c, const struct coord_worker *to,
                       const struct msg_back *back);
/* Has the worker attempts of the job in flight? */
bool holding_has_any(const struct job *job, const struct coord_worker *w);
/* The number of workers that are at the job: each loads it or is ready for it,
 * and does not rest, or work for jobs of a higher priority alone. */
uint32_t holding_workers(const struct job *job);
/* Bring the worker's coord_worker.priority up to date. */
void holding_rate(const struct coord *c, struct coord_worker *w);

/* Forget that rows of the unit came: these rows do not count any more. */
void holding_forget_rows(struct job *job, uint32_t unit);

#endif
