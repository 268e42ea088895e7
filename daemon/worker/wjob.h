/* wjob.h - the jobs of a worker: their units, results and children
 *
 * Thread: radd's loop. */
#ifndef DAEMON_WJOB_H
#define DAEMON_WJOB_H

#include "worker/state.h"

struct steps;

/* Which state may follow which, as drawn in state.h. */
extern const struct steps wjob_steps;
/* Change the job's state; the step must be in wjob_steps. */
void wjob_step(struct wjob *job, enum wjob_state to);

/* Is the JOB_START of this very job, and not of another job of the same id?  A
 * deleted job's id may be given to a new job while the worker is not connected,
 * and a job that the coordinator did not keep may begin with another cache when
 * it comes once more. */
bool wjob_is_same(struct worker *w, const struct wjob *job,
                  const struct msg *m);
/* Make the job of a JOB_START, in the worker's list; NULL: memory is out. */
struct wjob *wjob_new(struct worker *w, const struct msg *m);
/* Free a job that is no longer in the worker's list. */
void wjob_free(struct wjob *job);
/* Start the job's child, or kill it. */
void wjob_spawn(struct worker *w, struct wjob *job);
void wjob_kill_child(struct worker *w, struct wjob *job);
/* Tell the coordinator that the job's child is gone (LOST), and forget its
 * units.  Units that the child worked on are named as suspects, unless the
 * status tells of this machine (worker_status_is_local()). */
void wjob_send_lost(struct worker *w, struct wjob *job, int status,
                    const char *text);
/* The attempt, if the child has it; else NULL. */
struct wattempt *wjob_find_attempt(const struct wjob *job, uint32_t unit,
                                   uint32_t attempt);
bool wjob_has_attempt(const struct wjob *job, uint32_t unit, uint32_t attempt);
/* False: memory is out. */
bool wjob_add_attempt(struct wjob *job, uint32_t unit, uint32_t attempt);
void wjob_drop_attempt(struct wjob *job, uint32_t unit, uint32_t attempt);
/* Forget all units that are not finished, and their kept rows. */
void wjob_drop_attempts(struct wjob *job);
/* Forget a unit and its kept rows, and tell the child (REVOKE). */
void wjob_revoke_attempt(struct worker *w, struct wjob *job, uint32_t unit,
                         uint32_t attempt);
/* Keep the bytes of a RESULT until it is acknowledged; false: memory is out. */
bool wjob_keep(struct wjob *job, const struct msg_result *r,
               const uint8_t *bytes, size_t len);
void wjob_drop_kept(struct wjob *job, struct wkept **link);

/* The child gets the records of one more pass: tiles of it are no longer due.
 */
void wjob_next_pass(struct wjob *job);

/* Could this be a base line of the job? */
bool wjob_fits_line(const struct wjob *job, const struct msg_base_line *m);

#endif
