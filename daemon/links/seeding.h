/* seeding.h - who makes which of a job's deep ambient records
 *
 * Workers that begin together get a part of space each, by their speed, in a
 * SEED before their first unit.  Who comes later gets the records instead; the
 * part of one that goes is made when it is asked for.
 * Thread: one. */
#ifndef RADD_DAEMON_SEEDING_H
#define RADD_DAEMON_SEEDING_H

#include "desk/desk.h"

/* The first worker is ready: give a part to each worker that is there.  There
 * are no parts for one worker alone, nor where records are not shared. */
void seeding_begin(struct coord *c, struct job *job);

/* A worker is ready: send it its part, unless it had that or is late. */
void seeding_ready(struct coord *c, struct job *job, uint32_t index);

#endif
