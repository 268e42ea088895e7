/* team.h - the threads that render one window together
 *
 * The picture is the one that a thread alone would make, pixel by pixel, and
 * the rays are the same.  Each member takes a base line with the bar above it;
 * it samples the line close behind the member on the line above, whose
 * densities it needs, then fills the bar.  So the members move across the
 * window in echelon, and the hand-off between two lines is a number in memory.
 * Thread: team_work() from any number of threads at once; team_stop(),
 * team_open(), team_rays() and team_waited() from any; the others while nobody
 * works.  Rows are handed on by
 * one member at a time. */
#ifndef RADD_DAEMON_TEAM_H
#define RADD_DAEMON_TEAM_H

#include "picture/frame.h"

struct team;

/* Row number `row` of the window is done; rows come in order, each once.  The
 * pixels are borrowed for the call, which may wait. */
typedef void team_rows_fn(void *arg, int row, const struct rad_pixel *pixels);

/* A team of at most nthreads members for a window within the frame, which must
 * outlive it.  NULL: memory is out. */
struct team *team_new(const struct rad_frame *f, const struct rad_window *w,
                      int nthreads, team_rows_fn *fn, void *arg);
void team_free(struct team *t);

/* Work until there is no line left to begin, or the team is stopped. */
void team_work(struct team *t, struct rad_ctx *ctx);

/* Is there a line left to begin? */
bool team_open(struct team *t);

/* End early: each member leaves within a few pixels. */
void team_stop(struct team *t);

/* Of all members, so far; from any thread.  Rays are told some thousand at a
 * time, waits for the line above [s] when they are over; what a member spins
 * before it goes to sleep is no wait. */
uint64_t team_rays(const struct team *t);
double team_waited(struct team *t);

/* All rows were handed on. */
bool team_done(const struct team *t);

#endif
