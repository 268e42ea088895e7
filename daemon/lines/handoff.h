/* handoff.h - the coordinator passes on facts and base lines between workers
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_HANDOFF_H
#define DAEMON_HANDOFF_H

#include "desk/desk.h"

/* Handlers of FACTS, GUESS, BASE_LINE and PARKED, which workers send. */
void handoff_facts(struct coord *c, struct coord_worker *w,
                   const struct msg *msg);
void handoff_guess(struct coord *c, struct coord_worker *w,
                   const struct msg *msg);
void handoff_base_line(struct coord *c, struct coord_worker *w,
                       const struct msg *msg);
void handoff_parked(struct coord *c, struct coord_worker *w,
                    const struct msg *msg);

/* The flags of the UNIT message for an attempt that begins.  May also have it
 * make the unit's top. */
uint8_t handoff_flags(struct job *job, struct job_attempt *attempt);
/* Called when an attempt begins: send its worker the facts of the unit and as
 * much of its top as is here, and tell it and its neighbours of each other. */
void handoff_out(struct coord *c, struct job *job, struct job_attempt *attempt);
/* A worker came back and goes on with its units: as handoff_out(), but without
 * facts. */
void handoff_back(struct coord *c, struct job *job, uint32_t index);
/* Is the unit's bottom here, or needed by no unit? */
bool handoff_complete(const struct job *job, uint32_t unit);
/* A unit is done: drop its facts and its top. */
void handoff_done(struct job *job, uint32_t unit);
/* Send tops to waiting attempts that did not get them from another worker. */
void handoff_tick(struct coord *c, struct job *job);

#endif
