/* passes.h - a job's ambient cache, filled in passes before its units go out
 *
 * See passes.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PASSES_H
#define DAEMON_PASSES_H

#include "desk/desk.h"

struct passes;

void passes_free(struct passes *s);

/* Lay out the job's passes, if it has any; 0, or negative with *err. */
int passes_begin(struct coord *c, struct job *job, struct rad_error *err);

/* How far the passes of the present stage are. */
struct passes_state {
    uint32_t open, n; /* closed passes, and all passes; n 0: there are none */
    uint64_t bytes;   /* records so far */
    double made;      /* share of the first open pass's tiles that are made */
};
struct passes_state passes_state(const struct job *job);
/* Ask the store for another job's records that the job begins with, if these
 * are due and the store has the job. */
void passes_ask(struct coord *c, struct job *job);
/* The answer: n bytes of records, malloc'd and taken; or status, of sysexits.h
 * and not 0, and text say why there are none. */
void passes_came(struct coord *c, struct job *job, uint8_t *records, size_t n,
                 int status, const char *text);
/* Must all units wait, for tiles to be made or for records from the store? */
bool passes_open(const struct job *job);
/* All rows of a frame are here: a pass may now be closed. */
void passes_frame_done(struct coord *c, struct job *job);
/* Handler of TILE_MADE. */
void passes_made(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);

#endif
