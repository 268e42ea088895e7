/* quota.h - what one user may have at a coordinator
 *
 * Whoever may use it and no more is bounded in all that it can make grow, so
 * that nobody takes what others need; administrators and workers are not.  What
 * a user has is counted when it asks for more.  A request that goes over a
 * limit is refused with the limit's name, its value and what to do: status 75
 * where something of the user's will end by itself, 65 where the request alone
 * is more than the limit.
 * Private to the coordinator's own files, but struct coord_limits (coord.h).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_QUOTA_H
#define DAEMON_QUOTA_H

#include "desk/desk.h"

/* May the user have one more?  0, or RAD_ETEMPFAIL or RAD_EDATA with a message
 * for the user. */
int quota_job(const struct coord *c, const struct coord_conn *conn,
              const struct msg_spec *spec, struct rad_error *err);
/* Is that a priority which jobs may have?  0, or RAD_EUSAGE. */
int quota_priority(int32_t priority, struct rad_error *err);
int quota_upload(const struct coord *c, const struct coord_conn *conn,
                 struct rad_error *err);
int quota_file(const struct coord *c, const struct coord_conn *conn,
               uint64_t bytes, struct rad_error *err);
int quota_answer(const struct coord *c, const struct coord_conn *conn,
                 struct rad_error *err);

/* All limits, and what that user has of each, as JSON; NULL: memory is out. */
char *quota_report(const struct coord *c, const char *owner);

#endif
