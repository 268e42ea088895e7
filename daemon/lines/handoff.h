/* handoff.h - facts and base lines on their way between workers
 *
 * Thread: one. */
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

/* Flags of the UNIT for that holder, which it goes to now. */
uint8_t handoff_flags(struct job *job, uint32_t unit, struct job_go *go);
/* The unit went out to it. */
void handoff_out(struct coord *c, struct job *job, uint32_t unit,
                 struct job_go *go);
/* A worker that came back has units that go on: with it and their neighbours
 * all is as if they had just gone out. */
void handoff_back(struct coord *c, struct job *job, uint32_t index);
/* Since when the base line above a unit is here whole; 0: it is not. */
uint64_t handoff_top_ms(const struct job *job, uint32_t unit);
/* Is its bottom with us, if anybody needs it? */
bool handoff_complete(const struct job *job, uint32_t unit);
/* A unit is done. */
void handoff_done(struct job *job, uint32_t unit);
/* Send what parked units wait for, where it has not come otherwise. */
void handoff_tick(struct coord *c, struct job *job);

#endif
