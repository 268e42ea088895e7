/* records.h - the records of passes on their way to workers
 *
 * Those of a tile that is made travel to all workers while others are, by way
 * of some of them (links/feeding.h).  When a pass is closed a worker is told
 * so; if it lacks some it says so, and gets all of them, in the order of tiles;
 * a worker that comes later gets them of each pass that is closed.  What needs
 * the records waits at the worker until they are there; units do not go out to
 * a worker before it has said that they are.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_RECORDS_H
#define DAEMON_RECORDS_H

#include "desk/desk.h"

/* A worker is ready that has the records of so many passes: it gets those of
 * the others that are closed.  False: it has more than there are. */
bool records_ready(struct coord *c, struct job *job, uint32_t index,
                   uint32_t have);
/* Has the worker the records of the first `passes` of the job's stage, so that
 * it can make tiles that read them? */
bool records_allow(const struct job *job, uint32_t index, uint32_t passes);
/* A worker says that it has all of a pass that is closed, or lacks some. */
void records_held(struct coord *c, struct coord_worker *w,
                  const struct msg *msg);

/* A tile of an open pass is made. */
void records_feed(struct coord *c, struct job *job, uint32_t pass,
                  uint32_t tile);
/* One more pass is closed. */
void records_tell(struct coord *c, struct job *job);
/* Send the records of a closed pass to whoever keeps them (-af). */
void records_keep(struct coord *c, const struct job *job, uint32_t pass);
/* The records of the first pass came, from a former job. */
void records_came(struct coord *c, struct job *job);
/* Another stage begins: whichever pass workers are at, all begin anew. */
void records_drop(struct coord *c, struct job *job);

#endif
