/* estimate.h - an ESTIMATE that a child's threads work on
 *
 * Render threads take the estimate's areas one by one.  With a live ambient
 * cache all areas are gone over twice, at other pixels: the first pixels of a
 * job make records that all later pixels find, in whatever area, so only the
 * second pass measures an area's own cost.  When all areas are done the loop
 * thread sends the costs (ESTIMATED).  If the picture is shared by lines it
 * sends the pixels before that, as FACTS, so that they need not be traced
 * again.
 * Thread: estimate_open() and estimate_work(): any; all other functions: one,
 * before the threads begin or after they are done. */
#ifndef RADD_DAEMON_ESTIMATE_H
#define RADD_DAEMON_ESTIMATE_H

#include "proto/message.h"
#include "picture/frame.h"

/* Most pixels of an area that an ESTIMATE may ask for. */
#define ESTIMATE_MOST_RAYS 10000

struct estimate;

/* Make what the message asks for.  Its areas are copied; frames must outlive
 * the estimate.  NULL: RAD_EPROTO if an area lies in no frame or has too many
 * rays, or RAD_ENOMEM. */
struct estimate *estimate_new(const struct rad_frame *frames, uint32_t nframes,
                              const struct msg_estimate *m,
                              struct rad_error *err);
void estimate_free(struct estimate *e);

/* Is there an area that no thread has taken? */
bool estimate_open(const struct estimate *e);

/* Take areas and work on them until none is left, or *stop is set: then for at
 * most one more pixel. */
void estimate_work(struct estimate *e, struct rad_ctx *ctx,
                   const _Atomic bool *stop);

/* Add a thread's counts and processor time; called under the pool's lock. */
void estimate_count(struct estimate *e, const struct rad_counts *c,
                    double cpu_s);

/* The next FACTS, valid until the next call; NULL: there is none.  The caller
 * sets the job's id. */
struct msg_facts *estimate_facts(struct estimate *e);

/* The answer, whose job and wall_s the caller sets. */
void estimate_result(const struct estimate *e, struct msg_estimated *m);

#endif
