/* tiles.h - which worker makes which tile of the open passes
 *
 * Tiles of an earlier pass go out before tiles of a later pass, those of a pass
 * by their numbers.  A worker has a tile for each thread, and further tiles as
 * long as many wait.  When no tile waits, a tile that is out for long
 * goes to a second worker, too: its records do not depend on the worker.  Tiles
 * that a lost worker had go out again.  Thread: the coordinator's loop. */
#ifndef DAEMON_TILES_H
#define DAEMON_TILES_H

#include "desk/desk.h"

struct passes;
struct sheet;
struct tile;

/* Make the sheet of a pass that is open from now on; false: memory is out. */
bool tiles_open(struct passes *s, uint32_t pass);
/* Free the sheet of a pass, or of all passes. */
void tiles_close(struct passes *s, uint32_t pass);
void tiles_drop(struct passes *s);

/* Send a ready worker a tile; false: there is no tile for this worker. */
bool tiles_give(struct coord *c, struct job *job, uint32_t index);
/* The number of tiles that the worker has. */
uint32_t tiles_out(const struct job_part *part);
/* Has the worker tiles, or could it get one? */
bool tiles_has(const struct coord *c, const struct job *job, uint32_t index);
/* Take the tile from the worker; false: it did not have the tile. */
bool tiles_take(struct sheet *s, struct tile *t, uint32_t index);
/* Take all tiles from a worker that will not answer. */
void tiles_lost(struct job *job, uint32_t index);
/* A worker's child died: note that at the worker's tiles.  False: a tile has
 * brought down too many children, and the job has failed. */
bool tiles_crashed(struct coord *c, struct job *job, uint32_t index,
                   const char *why);

#endif
