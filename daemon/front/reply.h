/* reply.h - what the coordinator's answers to users have in common
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REPLY_H
#define DAEMON_REPLY_H

#include "desk/desk.h"

/* An ANSWER of that text, or that it is too long. */
void reply_answer(struct coord *c, const struct coord_conn *conn,
                  uint32_t request, const char *text);

/* Answer a request, without a text, once the store keeps the change that it
 * made: a user does not hear of a change that a crash could undo. */
void reply_settled(struct coord *c, struct coord_conn *conn, uint32_t request);

/* The store keeps that change: answer, once. */
void reply_kept(struct coord *c, struct coord_conn *conn, uint32_t request);

/* While the disk is full, tell users whose changes cannot be kept now. */
void reply_tick(struct coord *c);

/* Would a request be more than its user may have?  Then the user is told. */
typedef int reply_limit_fn(const struct coord *c, const struct coord_conn *conn,
                           struct rad_error *err);
bool reply_refused(struct coord *c, const struct coord_conn *conn,
                   const struct msg *m, reply_limit_fn *limit);

/* The job that a request names, if there is one and the sender may steer it, or
 * only `look` at it; else NULL, and the sender is told. */
struct job *reply_find_job(struct coord *c, struct coord_conn *conn,
                           uint32_t request, const uint8_t *id, bool look);

#endif
