/* handoff.h - facts and base lines on their way between workers
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_HANDOFF_H
#define DAEMON_HANDOFF_H

#include "desk/desk.h"

/* Messages of workers. */
void handoff_facts(struct coord *c, struct coord_worker *w,
                   const struct msg *msg);
void handoff_base_line(struct coord *c, struct coord_worker *w,
                       const struct msg *msg);
void handoff_parked(struct coord *c, struct coord_worker *w,
                    const struct msg *msg);

/* The flags of the UNIT message for that attempt, which begins now. */
uint8_t handoff_flags(struct job *job, uint32_t unit, struct job_go *go);
/* The unit went out for that attempt. */
void handoff_out(struct coord *c, struct job *job, uint32_t unit,
                 struct job_go *go);
/* A worker came back and goes on with its units: introduce it to the workers of
 * the units above and below, as if its units had just gone out. */
void handoff_back(struct coord *c, struct job *job, uint32_t index);
/* The time when the base line above a unit was here whole; 0: it is not. */
uint64_t handoff_top_ms(const struct job *job, uint32_t unit);
/* Is the unit's bottom here, if any unit below needs it? */
bool handoff_complete(const struct job *job, uint32_t unit);
/* A unit is done. */
void handoff_done(struct job *job, uint32_t unit);
/* Send tops to parked units that have not got them from another worker. */
void handoff_tick(struct coord *c, struct job *job);

#endif
