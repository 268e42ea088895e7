/* reply.h - the coordinator's answers to users
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REPLY_H
#define DAEMON_REPLY_H

#include "desk/desk.h"

/* Send ANSWER with that text, or FAILED if the text is too long. */
void reply_answer(struct coord *c, const struct coord_conn *conn,
                  uint32_t request, const char *text);

/* Send an empty ANSWER when the store has kept the change that the request
 * made: a user is not told of a change that a crash could undo. */
void reply_settled(struct coord *c, struct coord_conn *conn, uint32_t request);

/* The store has kept the request's change: send the answer, unless it was sent.
 */
void reply_kept(struct coord *c, struct coord_conn *conn, uint32_t request);

/* While the disk is full, tell users that their changes cannot be kept now. */
void reply_tick(struct coord *c);

/* Does the request exceed a limit of its user?  Then the user is told. */
typedef int reply_limit_fn(const struct coord *c, const struct coord_conn *conn,
                           struct rad_error *err);
bool reply_refused(struct coord *c, const struct coord_conn *conn,
                   const struct msg *m, reply_limit_fn *limit);

/* The job that a request names, if the sender may steer the job; with `look`,
 * if the sender may look at it.  NULL: there is no such job, or the sender may
 * not; the sender is told. */
struct job *reply_find_job(struct coord *c, struct coord_conn *conn,
                           uint32_t request, const uint8_t *id, bool look);

#endif
