/* joblife.h - the life of a job, apart from its units
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_JOBLIFE_H
#define DAEMON_JOBLIFE_H

#include "desk/desk.h"

/* How long a job that is over stays whole in memory. */
#define JOBLIFE_LINGER_MS 2000

/* Send PROGRESS of the job to a connection; ACCEPT; or how the job ended. */
void joblife_send_progress(struct coord *c, const struct coord_conn *conn,
                           const struct job *job);
void joblife_send_accept(struct coord *c, const struct coord_conn *conn,
                         const struct job *job, bool again);
void joblife_send_end(struct coord *c, const struct coord_conn *conn,
                      const struct job *job);

/* Put a job into the queue; false: memory is out. */
bool joblife_add(struct coord *c, struct job *job);
/* Change the job's priority; workers at other jobs give way within a tick. */
void joblife_set_priority(struct coord *c, struct job *job, int32_t priority);
/* If the job's files are all here, ask the store to make room for its rows. */
void joblife_try_open(struct coord *c, struct job *job);
/* The owner has sent a file: call joblife_try_open() for the jobs of the owner
 * that wait for this file. */
void joblife_file_came(struct coord *c, const struct coord_owner *owner,
                       const uint8_t hash[MSG_HASH]);
/* Called every tick: go on with opening jobs, and end those whose files do not
 * come. */
void joblife_tick(struct coord *c);
/* Have the store keep the job's state and priority. */
void joblife_keep_state(struct coord *c, const struct job *job);
/* The store has room for the job's rows; the store has written a picture.  A
 * status that is not 0 ends the job. */
void joblife_opened(struct coord *c, const uint8_t id[MSG_JOB],
                    uint64_t sequence, int status, const char *text);
void joblife_picture_written(struct coord *c, const uint8_t id[MSG_JOB],
                             uint64_t sequence, uint32_t frame, int status,
                             const char *text);
/* Carry out the verdicts on jobs (desk/verdict.h). */
void joblife_end_all(struct coord *c);
/* Free a job, with its passes, links and other memory of higher rooms; NULL is
 * accepted. */
void joblife_free(struct job *job);
/* Take the job out of the queue and free it. */
void joblife_drop(struct coord *c, struct job *job);

#endif
