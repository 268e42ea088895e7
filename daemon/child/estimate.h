/* estimate.h - an ESTIMATE that a child's threads work on
 *
 * The threads that render take its areas one by one.  Where ambient values are
 * kept they do so twice: the first pixels of a job make the values of half the
 * room, which the next ones find, whatever area they are in; so the first pass
 * is not counted, and the second, over as many other pixels, sees what is the
 * areas' own.  When all are done the loop's thread sends what they cost, ESTIMATED, and before it the pixels, as
 * FACTS, where the picture is shared by lines: they need not be traced again.
 * Thread: estimate_open() and estimate_work() from any; the others from one,
 * before the threads begin or after they are done. */
#ifndef RADD_DAEMON_ESTIMATE_H
#define RADD_DAEMON_ESTIMATE_H

#include "proto/message.h"
#include "picture/frame.h"

/* More pixels than this of one area are refused. */
#define ESTIMATE_MOST_RAYS 10000

struct estimate;

/* What the message asks for; its areas are copied, frames must outlive it.
 * NULL: RAD_EPROTO for an area that lies in no frame or for too many rays, or
 * RAD_ENOMEM. */
struct estimate *estimate_new(const struct rad_frame *frames, uint32_t nframes,
                              const struct msg_estimate *m,
                              struct rad_error *err);
void estimate_free(struct estimate *e);

/* Is there an area that nobody has taken? */
bool estimate_open(const struct estimate *e);

/* Work on areas until none is left; within a pixel of *stop, if that is set. */
void estimate_work(struct estimate *e, struct rad_ctx *ctx,
                   const _Atomic bool *stop);

/* Add what a thread counted while it worked, by the caller's clocks; under the
 * caller's lock. */
void estimate_count(struct estimate *e, const struct rad_counts *c,
                    double cpu_s);

/* The next FACTS, valid until the next call; NULL: there is none.  The job's id
 * is the caller's to fill in. */
struct msg_facts *estimate_facts(struct estimate *e);

/* The answer, likewise without the job's id; wall_s is the caller's.  It has no
 * areas where the work was stopped. */
void estimate_result(const struct estimate *e, struct msg_estimated *m);

#endif
