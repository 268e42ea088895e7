/* coord_job.h - the life of a job, as far as it is not the scheduler's
 *
 * Thread: one. */
#ifndef DAEMON_COORD_JOB_H
#define DAEMON_COORD_JOB_H

#include "desk/desk.h"

/* The job of that id, if it is the one of that number; NULL. */
struct job *coord_same_job(const struct coord *c, const uint8_t id[MSG_JOB],
                           uint64_t sequence);

/* To one who watches the job: how far it is, and the last words. */
void coord_send_progress(struct coord *c, const struct coord_conn *conn,
                         const struct job *job);
void coord_send_accept(struct coord *c, const struct coord_conn *conn,
                       const struct job *job, bool again);
void coord_send_end(struct coord *c, const struct coord_conn *conn,
                    const struct job *job);

/* Put a job into the queue; false when memory is out. */
bool coord_add_job(struct coord *c, struct job *job);
/* Higher goes first; jobs that work now give way within a tick. */
void coord_set_priority(struct coord *c, struct job *job, int32_t priority);
/* Once its files are all there, ask for room for its rows. */
void coord_try_open(struct coord *c, struct job *job);
/* That file of theirs came: open who waits for it. */
void coord_file_came(struct coord *c, const struct coord_owner *owner,
                     const uint8_t hash[MSG_HASH]);
/* Go on with opening, and end those whose files do not come. */
void coord_jobs_tick(struct coord *c);
/* The job is as it is now after a restart too. */
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
/* Free a job with all that others keep of it (NULL: nothing). */
void coord_free_job(struct job *job);
/* Take that one from the queue and free it: nothing leads to it any more. */
void coord_drop_job(struct coord *c, const struct job *job);

#endif
