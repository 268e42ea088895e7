/* passes.h - a job's ambient cache, filled in passes before its units go out
 *
 * See passes.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PASSES_H
#define DAEMON_PASSES_H

#include "desk/desk.h"

struct passes;

void passes_free(struct passes *s);

/* Lay out the passes, if the job has some; 0 or RAD_ENOMEM. */
int passes_begin(struct coord *c, struct job *job, struct rad_error *err);

/* How far they are. */
struct passes_state {
    uint32_t open, n; /* passes of the stage that are closed; all of them, 0:
                       * there are none */
    uint64_t bytes;   /* of their records */
    double made;      /* share of the open pass's tiles */
};
struct passes_state passes_state(const struct job *job);
/* The store has the job: ask it for the records that the job begins with, if
 * they are wanted by now. */
void passes_ask(struct coord *c, struct job *job);
/* The records that the job begins with, n bytes, malloc'd and taken; status: of
 * sysexits.h, they cannot be had. */
void passes_came(struct coord *c, struct job *job, uint8_t *records, size_t n,
                 int status, const char *text);
/* Do all units wait for tiles that are yet to be made, or for records? */
bool passes_open(const struct job *job);
/* All rows of a frame are there: passes may have waited for that. */
void passes_frame_done(struct coord *c, struct job *job);
/* A worker has made a tile. */
void passes_made(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);

#endif
