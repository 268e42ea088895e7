/* passes.h - a job's ambient cache, filled in passes before its units go out
 *
 * The head of passes.c says how passes are opened and closed.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PASSES_H
#define DAEMON_PASSES_H

#include "desk/desk.h"

struct passes;

void passes_free(struct passes *s);

/* Lay out the job's passes, if it has any; 0, or negative with *err. */
int passes_begin(struct coord *c, struct job *job, struct rad_error *err);

/* After a restart: note how far the passes were that an earlier life closed.
 * passes_begin() takes them up when the first worker is ready. */
void passes_restore(struct job *job);

/* How far the passes of the present stage are. */
struct passes_state {
    uint32_t open, n; /* closed passes, and all passes; n 0: there are none */
    uint64_t bytes;   /* records so far */
    double made;      /* share of the first open pass's tiles that are made */
};
struct passes_state passes_state(const struct job *job);
/* Ask the store for the records of another job with which this job begins, if
 * they are due and the store has this job. */
void passes_ask(struct coord *c, struct job *job);
/* The store's answer to that. */
void passes_came(struct coord *c, struct job *job,
                 const struct saved_cache *cache);
/* Must all units wait, for tiles to be made or for records from the store? */
bool passes_open(const struct job *job);
/* All rows of a frame are here: a pass may now be closed. */
void passes_frame_done(struct coord *c, struct job *job);
/* Handler of TILE_MADE. */
void passes_made(struct coord *c, struct coord_worker *w,
                 const struct msg *msg);

#endif
