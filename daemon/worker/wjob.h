/* wjob.h - the jobs of a worker: their units, results and children
 *
 * Thread: one. */
#ifndef DAEMON_WJOB_H
#define DAEMON_WJOB_H

#include "worker/state.h"

/* A job that starts here; NULL: memory is out. */
struct wjob *wjob_new(struct worker *w, const struct msg *m);
/* Free a job that is no longer in the worker's list. */
void wjob_free(struct wjob *job);
void wjob_spawn(struct worker *w, struct wjob *job);
void wjob_kill_child(struct worker *w, struct wjob *job);
/* Tell the coordinator that the job has no child here any more.  Units on which
 * nobody worked are not under suspicion, and none is if the reason lies here.
 */
void wjob_send_lost(struct worker *w, struct wjob *job, bool local,
                    const char *text);

/* The unit, if the child has it; else NULL. */
struct wunit *wjob_find_unit(const struct wjob *job, uint32_t unit,
                               uint32_t attempt);
bool wjob_has_unit(const struct wjob *job, uint32_t unit, uint32_t attempt);
/* False: memory is out. */
bool wjob_add_unit(struct wjob *job, uint32_t unit, uint32_t attempt);
void wjob_drop_unit(struct wjob *job, uint32_t unit, uint32_t attempt);
/* Forget all units that are not finished, and their rows. */
void wjob_drop_units(struct wjob *job);
/* Take a unit from the child, by a message. */
void wjob_revoke_unit(struct worker *w, struct wjob *job, uint32_t unit,
                      uint32_t attempt);
/* Keep the frame of a RESULT until it is acknowledged; false: memory is out. */
bool wjob_keep(struct wjob *job, const struct msg_result *r,
               const uint8_t *bytes, size_t len);
void wjob_drop_kept(struct wjob *job, struct wkept **link);

/* The child has got another pass: its tiles are of no use any more. */
void wjob_next_pass(struct wjob *job);

/* May that be a base line of the job? */
bool wjob_fits_line(const struct wjob *job, const struct msg_base_line *m);

#endif
