/* hold.h - which worker has which units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_HOLD_H
#define DAEMON_HOLD_H

#include "desk/desk.h"

/* Begin an attempt at a unit; NULL: there is no room for it. */
struct job_go *hold_add(struct coord *c, struct job *job, uint32_t index,
                        uint32_t unit, uint32_t attempt);
/* The worker that lost the unit turns out to be at it, or to have rows of it,
 * and nobody else began it: its attempt goes on.  False: memory is out. */
bool hold_revive(struct coord *c, struct job *job, uint32_t index,
                 uint32_t unit);
/* The attempt is in another state now. */
void hold_step(struct coord *c, struct job *job, uint32_t unit,
               struct job_go *go, enum go_state to);
/* The attempt has fewer lines of the unit now, or columns of one line. */
void hold_shrunk(struct job *job, uint32_t unit, struct job_go *go);
/* Cut a unit to so many rows, which is all that the attempt will do: the rest
 * is a new unit.  False: no line ends there. */
bool hold_shrink(struct coord *c, struct job *job, uint32_t unit,
                 struct job_go *go, uint32_t height);
/* End the attempt and free it; pointers to the unit's other attempts are not
 * valid any more. */
void hold_release(struct coord *c, struct job *job, uint32_t unit,
                  struct job_go *go);
/* The attempt has made the base line above its unit, if it was to, or will not.
 */
void hold_top_made(struct coord *c, struct job *job, uint32_t unit,
                   struct job_go *go);
/* Tell the worker that lent columns that it has them again (BACK). */
void hold_send_back(struct coord *c, const struct coord_worker *to,
                    const struct msg_back *back);
/* Bring the priority of the units that the worker has up to date. */
void hold_rate(const struct coord *c, struct coord_worker *w);

/* The rows that came of a unit do not count any more. */
void hold_forget_rows(struct job *job, uint32_t unit);

#endif
