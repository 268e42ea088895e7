/* dearest.h - in which order the tiles of a pass go out
 *
 * All workers wait for the last tile of a pass, so those that take longest go
 * out first: where earlier passes took many rays, this one will, too.  The
 * order has no influence on what a tile makes.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DEAREST_H
#define DAEMON_DEAREST_H

#include "passes/passplan.h"

struct dearest;

/* For pictures of these sizes, which must outlive it; NULL: memory is out. */
struct dearest *dearest_new(const struct rad_pass_size *size, uint32_t n);
void dearest_free(struct dearest *d);

/* That tile of a pass took so many rays. */
void dearest_note(struct dearest *d, const struct rad_pass *pass, uint32_t tile,
                  uint64_t rays);

/* The numbers of the pass's tiles, the dearest first, into order[]; what is as
 * dear in the order of tiles.  False: memory is out. */
bool dearest_order(const struct dearest *d, const struct rad_pass *pass,
                   uint32_t *order);

#endif
