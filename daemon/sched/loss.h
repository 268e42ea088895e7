/* loss.h - workers and children that go, and what becomes of their units
 *
 * Thread: one. */
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
/* A holder will not finish the unit: another does, or it waits again. */
void loss_of(struct coord *c, struct job *job, uint32_t unit,
             struct job_go *go);
/* It is to have the unit no more (REVOKE). */
void loss_taken(struct coord *c, struct job *job, uint32_t unit,
                struct job_go *go);
/* It gave the unit back, with all that it knew of it. */
void loss_given_back(struct coord *c, struct job *job, uint32_t unit,
                     struct job_go *go);
/* What that attempt at the unit lends is its own again. */
void loss_end_loans(struct coord *c, struct job *job, uint32_t unit,
                    uint32_t lender);
/* A worker loses its part in the job, which is in that state then. */
void loss_all(struct coord *c, struct job *job, uint32_t index,
              enum part_state to);
/* Units that a worker lost wait for it that long, while its connection is to be
 * made again. */
void loss_keep(const struct coord *c, struct job *job, uint32_t index,
               uint64_t ms);
/* They do not any more, where the time is over. */
void loss_tick(struct coord *c, struct job *job);
/* A worker that had part in the job before says that it is ready.  Of its units
 * it is at those that it said so of (STILL).  All that comes of another is what
 * came since it was gone, before the job's start reached it. */
void loss_at_ready(struct coord *c, struct job *job, uint32_t index);
/* Is there another worker than that one that may do the job?  late: also if it
 * is late. */
bool loss_others_may(const struct coord *c, const struct job *job,
                     const struct coord_worker *w, bool late);

#endif
