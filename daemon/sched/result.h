/* result.h - rows that come, and units that are done
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_RESULT_H
#define DAEMON_RESULT_H

#include "desk/desk.h"

/* A message of a worker. */
void result_rows(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);
/* Rows are kept. */
void result_stored(struct coord *c, const struct action_rows *key);
/* All rows of the frame are kept: its picture is to be written. */
void result_frame_done(struct coord *c, struct job *job, uint32_t frame);

#endif
