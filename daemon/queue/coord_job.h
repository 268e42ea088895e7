/* coord_job.h - the life of a job, as far as it is not the scheduler's
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_JOB_H
#define DAEMON_COORD_JOB_H

#include "desk/desk.h"

/* To a connection that watches the job: how far the job is, that it is
 * accepted, and how it ended. */
void coord_send_progress(struct coord *c, const struct coord_conn *conn,
                         const struct job *job);
void coord_send_accept(struct coord *c, const struct coord_conn *conn,
                       const struct job *job, bool again);
void coord_send_end(struct coord *c, const struct coord_conn *conn,
                    const struct job *job);

/* Put a job into the queue; false when memory is out. */
bool coord_add_job(struct coord *c, struct job *job);
/* Jobs of higher priority go first; jobs that work now give way within a tick.
 */
void coord_set_priority(struct coord *c, struct job *job, int32_t priority);
/* Once the job's files are all there, ask the store for room for its rows. */
void coord_try_open(struct coord *c, struct job *job);
/* The owner has sent that file: open the jobs that wait for it. */
void coord_file_came(struct coord *c, const struct coord_owner *owner,
                     const uint8_t hash[MSG_HASH]);
/* Go on with opening jobs, and end those whose files do not come. */
void coord_jobs_tick(struct coord *c);
/* Have the store keep the job's state and priority. */
void coord_keep_state(struct coord *c, const struct job *job);
/* The job has room for its rows, or a picture was written; a status other than
 * 0 ends the job. */
void coord_open_job(struct coord *c, const uint8_t id[MSG_JOB],
                    uint64_t sequence, int status, const char *text);
void coord_take_picture(struct coord *c, const uint8_t id[MSG_JOB],
                        uint64_t sequence, uint32_t frame, int status,
                        const char *text);
/* Carry out the verdicts on jobs (desk/verdict.h). */
void coord_end_jobs(struct coord *c);
/* Free a job (NULL: nothing) with all that higher rooms keep of it. */
void coord_free_job(struct job *job);
/* Take the job from the queue and free it. */
void coord_drop_job(struct coord *c, const struct job *job);

#endif
