/* loss.h - workers and children that are lost, and their attempts at units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LOSS_H
#define DAEMON_LOSS_H

#include "desk/desk.h"

/* Handlers of LOST, ROOM and STILL. */
void loss_reported(struct coord *c, struct coord_worker *w,
                   const struct msg *msg);
void loss_no_room(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);
void loss_still(struct coord *c, struct coord_worker *w, const struct msg *msg);

/* A worker's connection is gone: end its attempts; their units wait again. */
void loss_worker_gone(struct coord *c, struct coord_worker *w);
/* End an attempt that did not finish the unit: another attempt goes on, or the
 * unit waits again. */
void loss_of(struct coord *c, struct job *job, struct job_attempt *attempt);
/* The same, and take the unit from the attempt's worker (REVOKE). */
void loss_taken(struct coord *c, struct job *job, struct job_attempt *attempt);
/* End an attempt whose worker gave the whole unit back (GAVE), after its facts.
 */
void loss_given_back(struct coord *c, struct job *job,
                     struct job_attempt *attempt);
/* End the loans of attempt `lender`, which is over or has another last line
 * now.
 */
void loss_end_loans(struct coord *c, struct job *job, uint32_t unit,
                    uint32_t lender);
/* End all that the worker does for the job, and put its part in state `to`. */
void loss_all(struct coord *c, struct job *job, uint32_t index,
              enum part_state to);
/* Keep units that the worker lost for it for so long, in case it connects
 * again: no other worker gets them. */
void loss_keep(const struct coord *c, struct job *job, uint32_t index,
               uint64_t ms);
/* Let other workers have the units that were kept long enough. */
void loss_tick(struct coord *c, struct job *job);
/* A worker is READY again.  It goes on with the units that it named by STILL.
 * Any other attempt of its is lost, unless all its rows came before READY. */
void loss_at_ready(struct coord *c, struct job *job, uint32_t index);

#endif
