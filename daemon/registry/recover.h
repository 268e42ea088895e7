/* recover.h - after a restart: jobs of an earlier life of the coordinator
 *
 * Jobs are made again of all that the store kept.  Units whose rows are all
 * there are done.  Other units wait as if their workers had just been lost, at
 * first for these workers alone: a worker that connects again goes on with its
 * unit.  Facts, and base lines of units that are not done, were only in memory
 * and are lost.  The last base line of a unit that is done is made again from
 * the unit's last row and the densities that were kept with it, so the sampler
 * goes on as if nothing had happened.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_RECOVER_H
#define DAEMON_RECOVER_H

#include "desk/desk.h"

/* Read row y of a frame into width * channels floats, as on the wire; false: it
 * cannot be read. */
typedef bool recover_row_fn(void *arg, const uint8_t job[MSG_JOB],
                            uint32_t frame, uint32_t y, uint8_t *pixels);

/* Take up a job, before any event; call it for the jobs in the order in which
 * the store kept them.  All that *s points at is copied.  has_file() and
 * random() of the environment are not called.  RAD_EDATA: the kept units,
 * frames and base lines do not fit together; RAD_ENOMEM. */
int recover_job(struct coord *c, uint64_t now_ms, const struct saved_job *s,
                recover_row_fn *row, void *arg, struct rad_error *err);

/* Note that the worker of that name is drained: it gets no units when it
 * connects.  RAD_ENOMEM. */
int recover_drained(struct coord *c, uint64_t now_ms, const char *name,
                    struct rad_error *err);

#endif
