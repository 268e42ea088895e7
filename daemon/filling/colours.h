/* colours.h - colours that tiles of passes report, for a preview
 *
 * Once a preview was asked for (job->watched), tiles of coarse lattices report
 * the colours of their pixels, and folder/coarse.h fills previews with these
 * colours.  If a tile is made twice the first colours stay.  Records, counts
 * and pictures do not depend on colours.  Thread: the coordinator's loop. */
#ifndef DAEMON_COLOURS_H
#define DAEMON_COLOURS_H

#include "desk/desk.h"
#include "passes/passplan.h"

/* Shall a tile of the pass report its colours? */
bool colours_wanted(const struct job *job, const struct rad_pass *pass);

/* Is len a size that the colours of this tile may have? */
bool colours_fit(const struct job *job, const struct rad_pass *pass,
                 uint32_t tile, size_t len);

/* Give the store the colours that the tile reported, if any. */
void colours_keep(struct coord *c, struct job *job, const struct rad_pass *pass,
                  const struct msg_tile_made *m);

/* The pass is closed: if its tiles reported colours, note in has_colours of its
 * frames that a preview can be made. */
void colours_close(struct job *job, const struct rad_pass *pass);

#endif
