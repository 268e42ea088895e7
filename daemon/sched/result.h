/* result.h - rows come, and units and frames are done
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_RESULT_H
#define DAEMON_RESULT_H

#include "desk/desk.h"

/* Handler of RESULT. */
void result_rows(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);
/* Event: rows are on the disk. */
void result_stored(struct coord *c, const struct action_rows *key);
/* All rows of the frame are on the disk: have its picture written. */
void result_frame_done(struct coord *c, struct job *job, uint32_t frame);

#endif
