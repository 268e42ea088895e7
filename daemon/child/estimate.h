/* estimate.h - an ESTIMATE that a child's threads work on
 *
 * Render threads take the estimate's areas one by one.  Where ambient records
 * are made as rays ask for them the areas are gone over twice.  The first
 * pixels of a job make records for half the room, which all later pixels find,
 * in whatever area; so the first pass is not counted, and the second, over as
 * many other pixels, measures each area's own cost.  When all areas are done
 * the loop's thread sends the costs (ESTIMATED).  Where the picture is shared
 * by lines it sends the pixels before, as FACTS, and they need not be traced
 * again. Thread: estimate_open() and estimate_work() from any; the others from
 * one, before the threads begin or after they are done. */
#ifndef RADD_DAEMON_ESTIMATE_H
#define RADD_DAEMON_ESTIMATE_H

#include "proto/message.h"
#include "picture/frame.h"

/* The most pixels of an area; more are refused. */
#define ESTIMATE_MOST_RAYS 10000

struct estimate;

/* An estimate as the message asks.  Its areas are copied, frames must outlive
 * the estimate.  NULL: RAD_EPROTO for an area that lies in no frame or for too
 * many rays, or RAD_ENOMEM. */
struct estimate *estimate_new(const struct rad_frame *frames, uint32_t nframes,
                              const struct msg_estimate *m,
                              struct rad_error *err);
void estimate_free(struct estimate *e);

/* Is there an area that nobody has taken? */
bool estimate_open(const struct estimate *e);

/* Work on areas until none is left, or until *stop is set: then for at most one
 * pixel more. */
void estimate_work(struct estimate *e, struct rad_ctx *ctx,
                   const _Atomic bool *stop);

/* Add a thread's counts and processor time; under the caller's lock. */
void estimate_count(struct estimate *e, const struct rad_counts *c,
                    double cpu_s);

/* The next FACTS, valid until the next call; NULL: there is none.  The job's id
 * is the caller's to fill in. */
struct msg_facts *estimate_facts(struct estimate *e);

/* The answer, likewise without the job's id; wall_s is the caller's.  It has no
 * areas where the work was stopped. */
void estimate_result(const struct estimate *e, struct msg_estimated *m);

#endif
