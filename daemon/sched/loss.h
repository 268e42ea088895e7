/* loss.h - workers and children that go, and their units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LOSS_H
#define DAEMON_LOSS_H

#include "desk/desk.h"

/* Messages of workers. */
void loss_reported(struct coord *c, struct coord_worker *w,
                   const struct msg *msg);
void loss_no_room(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);
void loss_still(struct coord *c, struct coord_worker *w,
                const struct msg *msg);

/* A worker went: its units wait again. */
void loss_worker_gone(struct coord *c, struct coord_worker *w);
/* An attempt at the unit is over, unfinished: another attempt goes on, or the
 * unit waits again. */
void loss_of(struct coord *c, struct job *job, uint32_t unit,
             struct job_go *go);
/* Take the unit from the worker of that attempt (REVOKE). */
void loss_taken(struct coord *c, struct job *job, uint32_t unit,
                struct job_go *go);
/* The worker gave the unit back (GAVE); its facts came before. */
void loss_given_back(struct coord *c, struct job *job, uint32_t unit,
                     struct job_go *go);
/* End the loans of that attempt at the unit: its columns are its own again. */
void loss_end_loans(struct coord *c, struct job *job, uint32_t unit,
                    uint32_t lender);
/* End a worker's part in the job, and with it all its attempts; the part's
 * state is `to` then. */
void loss_all(struct coord *c, struct job *job, uint32_t index,
              enum part_state to);
/* For that long, units that the worker lost go to nobody else: its connection
 * may be made again. */
void loss_keep(const struct coord *c, struct job *job, uint32_t index,
               uint64_t ms);
/* End that wait for workers that did not come back in time. */
void loss_tick(struct coord *c, struct job *job);
/* A worker that was in the job before is READY again.  It works at the units
 * that it named by STILL.  Another attempt of this worker goes on only if all
 * its rows came before READY; else it is lost. */
void loss_at_ready(struct coord *c, struct job *job, uint32_t index);

#endif
