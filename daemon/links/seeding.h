/* seeding.h - which worker makes which of a job's deep ambient records
 *
 * With --ambient=live alone: in passes all are made by tiles
 * (filling/passes.h). Workers that begin together each get a part of space, by
 * their speed, in a SEED before their first unit.  A worker that comes later is
 * sent the records instead.  Records in the part of a worker that goes are made
 * when a ray asks for them. Thread: one. */
#ifndef RADD_DAEMON_SEEDING_H
#define RADD_DAEMON_SEEDING_H

#include "desk/desk.h"

/* The first worker is ready: give a part to each connected worker.  There are
 * no parts for one worker alone, nor where records are not shared. */
void seeding_begin(struct coord *c, struct job *job);

/* A worker is ready: send SEED with its part, unless the worker got that before
 * or is late. */
void seeding_ready(struct coord *c, struct job *job, uint32_t index);

#endif
