/* recover.h - jobs of an earlier life of the coordinator
 *
 * What the store remembers of a job becomes a job again: units that are kept
 * are done, the others wait as if their workers had just gone, for these alone
 * for a while: a worker that calls goes on with the unit that it is at.  What
 * was in memory alone is lost: facts, base lines under way, which worker had
 * which unit.  The base lines below units that are done are put together again
 * from the rows and the densities kept with them, so the sampler goes on as if
 * nothing had been.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_RECOVER_H
#define DAEMON_RECOVER_H

#include "desk/desk.h"

/* Read row y of a frame: width * channels floats as on the wire; false: it
 * cannot be read. */
typedef bool recover_row_fn(void *arg, const uint8_t job[MSG_JOB],
                            uint32_t frame, uint32_t y, uint8_t *pixels);

/* Take up a job, before any event; those of a coordinator in the order in which
 * they were submitted.  All that *s points at is copied.  RAD_EDATA: what is
 * saved makes no sense; RAD_ENOMEM. */
int recover_job(struct coord *c, uint64_t now_ms, const struct saved_job *s,
                recover_row_fn *row, void *arg, struct rad_error *err);

/* Take up a worker that was drained: it gets no units when it comes. */
int recover_drained(struct coord *c, uint64_t now_ms, const char *name,
                    struct rad_error *err);

#endif
