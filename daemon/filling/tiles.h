/* tiles.h - which worker makes which tile of the open passes
 *
 * Those of the first open pass go out before those of the next, and the dearest
 * first (dearest.h): one for each thread of a worker, and some ahead as long as
 * many of the pass wait.  When none is left, those that are out for long go to
 * a second worker: a tile has the same records whoever makes it.  What a worker
 * had and did not send is made again by others.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_TILES_H
#define DAEMON_TILES_H

#include "desk/desk.h"

struct passes;
struct sheet;
struct tile;

/* A pass is open from now on: make its sheet, with no tile out; false: out of
 * memory. */
bool tiles_open(struct passes *s, uint32_t pass);
/* Free the sheet of a pass; of all passes. */
void tiles_close(struct passes *s, uint32_t pass);
void tiles_drop(struct passes *s);

/* A tile for a worker that is ready; false: there is none for it. */
bool tiles_give(struct coord *c, struct job *job, uint32_t index);
/* How many tiles the worker has. */
uint32_t tiles_out(const struct job_worker *jw);
/* Are there tiles that the worker could have, or does it have some? */
bool tiles_has(const struct coord *c, const struct job *job, uint32_t index);
/* The worker does not have the tile any more; false: it did not have it. */
bool tiles_take(struct sheet *s, struct tile *t, uint32_t index);
/* The worker will not answer: others get its tiles. */
void tiles_lost(struct job *job, uint32_t index);
/* A child died while it had tiles: is one of them to blame?  False: the job
 * cannot go on. */
bool tiles_crashed(struct coord *c, struct job *job, uint32_t index,
                   const char *why);

#endif
