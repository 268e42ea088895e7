/* records.h - send the records of passes to workers
 *
 * When a tile is made its records travel to all workers at once, through some
 * of the workers (desk/feeding.h).  When a pass is closed each worker is told
 * (CLOSED); a worker that lacks records of the pass says so (HOLDS) and gets
 * all of its records, in the order of tiles (FROZEN).  A worker that comes
 * later gets all closed passes.  A tile that reads a pass waits in its worker
 * for the records of the pass; units go only to a worker that has said that it
 * has all records.  Thread: the coordinator's loop. */
#ifndef DAEMON_RECORDS_H
#define DAEMON_RECORDS_H

#include "desk/desk.h"

/* A worker is ready and has the records of the first `have` passes: send it the
 * records of the other closed passes.  False: it has records of passes that are
 * not closed, or that may be of another stage. */
bool records_ready(struct coord *c, struct job *job, uint32_t index,
                   uint32_t have);
/* May the worker get tiles that read the stage's first `passes` passes: has it
 * the records of these passes, or does it get them before such a tile? */
bool records_allow(const struct job *job, uint32_t index, uint32_t passes);
/* Handler of HOLDS: a worker has all records of a closed pass, or lacks some.
 */
void records_holds(struct coord *c, struct coord_worker *w,
                   const struct msg *msg);

/* A tile of an open pass is made: send its records. */
void records_feed(struct coord *c, struct job *job, uint32_t pass,
                  uint32_t tile);
/* A pass was closed: tell the workers. */
void records_tell(struct coord *c, struct job *job);
/* Send the records of a closed pass to the radsubmits that wait (-af). */
void records_to_users(struct coord *c, const struct job *job, uint32_t pass);
/* Another job's records came as the first pass: send these to the workers. */
void records_came(struct coord *c, struct job *job);
/* Another stage begins: tell all workers to begin with an empty cache. */
void records_drop(struct coord *c, struct job *job);

#endif
