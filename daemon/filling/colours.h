/* colours.h - what tiles of passes tell of the picture, for whoever watches it
 *
 * From the first FETCH of a picture that is not whole (job->watched) tiles of
 * coarse lattices tell the colours of their pixels, and previews are filled
 * from these (folder/coarse.h).  Of a tile that is made twice the first ones
 * count.  They decide nothing: neither records nor counts nor pictures know of
 * them.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COLOURS_H
#define DAEMON_COLOURS_H

#include "desk/desk.h"
#include "passes/passplan.h"

/* Is a tile of that pass to tell its colours? */
bool colours_wanted(const struct job *job, const struct rad_pass *pass);

/* May the tile, which the pass has, have sent so many bytes of them? */
bool colours_fit(const struct job *job, const struct rad_pass *pass,
                 uint32_t tile, size_t len);

/* Have the tile's colours kept, if it sent some. */
void colours_keep(struct coord *c, struct job *job, const struct rad_pass *pass,
                  const struct msg_tile_made *m);

/* The pass is closed: frames that it goes over can be seen as a whole. */
void colours_close(struct job *job, const struct rad_pass *pass);

#endif
