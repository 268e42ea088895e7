/* coord.h - the coordinator's decisions, apart from sockets, disks and clocks
 *
 * A pure machine: each event function below may append actions (action.h) to
 * the list that coord_actions() gives.  The shell (radcoord.c) carries them out
 * in order and clears the list before it delivers the next event.  The same
 * events with the same times and random bytes give the same actions.
 *
 * Workers are known by name, connections by number.  A worker's new connection
 * replaces its old one; its units go back and are handed out again, unless the
 * rows that were missing arrive first.  Jobs are served by priority;
 * equals share the workers by owner, and an owner's are served in the order in
 * which they came.  A worker serves the first job that has a unit for it.
 *
 * now_ms: milliseconds on a clock that never goes back.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_H
#define DAEMON_COORD_H

#include "desk/env.h"

struct coord;

/* NULL when memory is out. */
struct coord *coord_new(const struct coord_env *env);
void coord_free(struct coord *c);

/* How long jobs that are over are remembered; at first the last 100. */
void coord_set_keep(struct coord *c, const struct coord_keep *keep);

/* What a user may have; at first more than a room of people needs. */
void coord_set_limits(struct coord *c, const struct coord_limits *limits);

/* The number of this life, once it is known; before any event but those of
 * recover.h. */
void coord_set_epoch(struct coord *c, uint64_t epoch);

/* A unit is late when it is out for ten times as long as its job's units take,
 * but not before this [ms], 60000 at first. */
void coord_set_lease(struct coord *c, uint64_t ms);

struct action_list *coord_actions(struct coord *c);

/* --- events --- */

/* A connection came in; its session is MSG_AT_COORD_NEW. */
void coord_opened(struct coord *c, uint64_t now_ms, uint64_t conn,
                  const struct coord_peer *peer);

/* The connection is gone, for whatever reason; why is for the log. */
void coord_closed(struct coord *c, uint64_t now_ms, uint64_t conn,
                  const char *why);

/* A message arrived that the session of the connection allows. */
void coord_message(struct coord *c, uint64_t now_ms, uint64_t conn,
                   const struct msg *m);

/* ACT_PUT_CHUNK made a file whole, or failed (status of sysexits.h). */
void coord_file_stored(struct coord *c, uint64_t now_ms, uint64_t conn,
                       const uint8_t hash[MSG_HASH]);
void coord_file_failed(struct coord *c, uint64_t now_ms, uint64_t conn,
                       const uint8_t hash[MSG_HASH], int status,
                       const char *text);

/* Is that file there for the user of that connection?  A user who has not sent
 * it is not to know whether others have. */
bool coord_has_file(const struct coord *c, uint64_t conn,
                    const uint8_t hash[MSG_HASH]);

/* The files of an OFFER are known. */
void coord_looked(struct coord *c, uint64_t now_ms,
                  const struct action_look *l);

/* Answers of the store: status 0, or of sysexits.h with a text.  sequence is
 * the action's: an answer about a job that was deleted is none about the one
 * that has its id now. */
/* To ACT_JOB_OPEN.  Before that, if there is no room for the job's rows now,
 * coord_job_waits(): this job is held, and no other. */
void coord_job_opened(struct coord *c, uint64_t now_ms,
                      const uint8_t job[MSG_JOB], uint64_t sequence, int status,
                      const char *text);
void coord_job_waits(struct coord *c, uint64_t now_ms,
                     const uint8_t job[MSG_JOB], uint64_t sequence,
                     const char *text);
/* To ACT_PUT_ROWS, in their order. */
void coord_rows_stored(struct coord *c, uint64_t now_ms,
                       const struct action_rows *key, int status,
                       const char *text);
/* To ACT_WRITE_PICTURE. */
void coord_picture_written(struct coord *c, uint64_t now_ms,
                           const uint8_t job[MSG_JOB], uint64_t sequence,
                           uint32_t frame, int status, const char *text);
/* To ACT_SETTLE: all that was asked for before is kept. */
void coord_settled(struct coord *c, uint64_t now_ms, uint64_t conn,
                   uint32_t request);
/* To ACT_JOB_END and ACT_DROP_CACHE: bytes that the job's folder takes, and the
 * ambient cache that is kept in it. */
void coord_job_filed(struct coord *c, uint64_t now_ms,
                     const uint8_t job[MSG_JOB], uint64_t sequence,
                     uint64_t bytes, uint64_t cache_bytes);
/* To ACT_LOAD_CACHE: n bytes, malloc'd and taken. */
void coord_cache_came(struct coord *c, uint64_t now_ms,
                      const uint8_t job[MSG_JOB], uint64_t sequence,
                      uint8_t *records, size_t n, int status, const char *text);

/* ACT_SEND_PICTURE has sent the whole picture, or failed. */
void coord_sent(struct coord *c, uint64_t conn);

/* The hashes of all files that are needed: of its jobs, those that are over
 * too, and those that wait for a job.  *n of them, in any order, to be freed;
 * NULL when memory is out. */
uint8_t *coord_files(const struct coord *c, size_t *n);

/* The disk is full: jobs are held until there is room again.  text: where. */
void coord_fullness(struct coord *c, uint64_t now_ms, bool full,
                    const char *text);

/* The worker of that name is no longer welcome: the others of its jobs are told
 * to have no more to do with it.  Its connection is the shell's to close. */
void coord_expel(struct coord *c, uint64_t now_ms, const char *name);

/* Time passes; call it about every 100 ms. */
void coord_tick(struct coord *c, uint64_t now_ms);

/* --- what the shell may look at --- */

/* What is to be kept of a job, but for its frames and units; false if there is
 * no such job.  Valid until the next event. */
bool coord_saved(const struct coord *c, const uint8_t job[MSG_JOB],
                 struct saved_job *out);

#endif
