/* dearest.h - the order in which the tiles of a pass go out
 *
 * All workers wait for the last tile of a pass, so the dearest tiles go out
 * first: the tiles at pixels where earlier passes took many rays.  The order
 * does not change the records that a tile makes.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DEAREST_H
#define DAEMON_DEAREST_H

#include "passes/passplan.h"

struct dearest;

/* Make the memory of rays for n pictures of these sizes; size[] must outlive
 * it.  NULL: memory is out. */
struct dearest *dearest_new(const struct rad_pass_size *size, uint32_t n);
void dearest_free(struct dearest *d);

/* Note how many rays a tile of a pass took. */
void dearest_note(struct dearest *d, const struct rad_pass *pass, uint32_t tile,
                  uint64_t rays);

/* Set order[] to the numbers of the pass's tiles, the dearest first, tiles that
 * are equally dear in the order of their numbers.  False: memory is out. */
bool dearest_order(const struct dearest *d, const struct rad_pass *pass,
                   uint32_t *order);

#endif
