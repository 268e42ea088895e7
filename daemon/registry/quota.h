/* quota.h - limits of what one user may have at a coordinator
 *
 * All that a user can make grow is limited, so that no user takes the room of
 * others; administrators and workers have no limits.  A user's jobs, files and
 * answers are counted when the user asks for more.  A request beyond a limit is
 * refused with the limit's name, its value and what to do: with RAD_ETEMPFAIL
 * (status 75) if waiting may help, with RAD_EDATA (65) if the request alone
 * exceeds the limit.
 * A user's connections stand in line for the limit of jobs: while one whose job
 * was refused stays, later ones leave it a place.  Else who asks at the right
 * moment would have each place, and a job that waits might wait for ever.
 * Private to the coordinator's own files, but for struct coord_limits (env.h).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_QUOTA_H
#define DAEMON_QUOTA_H

#include "desk/desk.h"

/* May the user of the connection have this further job?  0; or RAD_ETEMPFAIL or
 * RAD_EDATA, with a message for the user.  Notes whether the connection is in
 * line. */
int quota_job(const struct coord *c, struct coord_conn *conn,
              const struct msg_spec *spec, struct rad_error *err);
/* May a job have that priority?  0, or RAD_EUSAGE. */
int quota_priority(int32_t priority, struct rad_error *err);
/* As quota_job(): may the user send a further bundle; send a further file, of
 * so many bytes; have a further answer under way? */
int quota_upload(const struct coord *c, const struct coord_conn *conn,
                 struct rad_error *err);
int quota_file(const struct coord *c, const struct coord_conn *conn,
               uint64_t bytes, struct rad_error *err);
int quota_answer(const struct coord *c, const struct coord_conn *conn,
                 struct rad_error *err);

/* All limits, and how much of each the user has, as JSON; NULL: memory is out.
 */
char *quota_report(const struct coord *c, const char *owner);

#endif
