/* coord.h - the coordinator's decisions, apart from sockets, disks and clocks
 *
 * A pure machine: each event function below may append actions (action.h) to
 * the list that coord_actions() returns.  The shell (radcoord.c) carries them
 * out in order and clears the list before the next event.  The same events with
 * the same times and random bytes give the same actions.
 *
 * Workers are known by name, connections by number.  A worker's new connection
 * replaces its old connection; its units are handed out again, unless the
 * worker goes on with them or their missing rows come first.  Jobs are served
 * by priority.  Jobs of equal priority share the workers by owner, and an
 * owner's jobs come in the order in which they were submitted.  A worker gets
 * units of the first job that has a unit for the worker.
 *
 * now_ms: Unix time [ms], by a clock that was set once, at the start, never
 * goes back, and stands still while the machine sleeps; dates that users read
 * have that sleep (desk_date_ms()).  In tests/sim it is the simulation's own
 * time.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_H
#define DAEMON_COORD_H

#include "desk/env.h"

struct coord;

/* NULL: memory is out. */
struct coord *coord_new(const struct coord_env *env);
void coord_free(struct coord *c);

/* How long jobs that are over are remembered; at first the last 100. */
void coord_set_keep(struct coord *c, const struct coord_keep *keep);

/* Limits of a user; at first more than a room of people needs. */
void coord_set_limits(struct coord *c, const struct coord_limits *limits);

/* Set the number of this life of the coordinator, before any event; jobs may be
 * recovered before (recover.h). */
void coord_set_epoch(struct coord *c, uint64_t epoch);

/* Least time after which a unit may count as late [ms], 60000 at first; the
 * unit also has to be out for ten times as long as the job's units usually are.
 */
void coord_set_lease_floor(struct coord *c, uint64_t ms);

struct action_list *coord_actions(struct coord *c);

/* --- events --- */

/* A connection was accepted; its session is MSG_AT_COORD_NEW. */
void coord_opened(struct coord *c, uint64_t now_ms, uint64_t conn,
                  const struct coord_peer *peer);

/* A connection has ended; why is for the log. */
void coord_closed(struct coord *c, uint64_t now_ms, uint64_t conn,
                  const char *why);

/* A message came, which the session of the connection allows. */
void coord_message(struct coord *c, uint64_t now_ms, uint64_t conn,
                   const struct msg *m);

/* ACT_PUT_CHUNK made a file whole; a file failed, with a status of sysexits.h.
 */
void coord_file_stored(struct coord *c, uint64_t now_ms, uint64_t conn,
                       const uint8_t hash[MSG_HASH]);
void coord_file_failed(struct coord *c, uint64_t now_ms, uint64_t conn,
                       const uint8_t hash[MSG_HASH], int status,
                       const char *text);

/* May the user of the connection know that the file is here?  The user must not
 * learn whether other users have sent it. */
bool coord_has_file(const struct coord *c, uint64_t conn,
                    const uint8_t hash[MSG_HASH]);

/* The store has looked at the files of an OFFER, as env.look() asked. */
void coord_looked(struct coord *c, uint64_t now_ms,
                  const struct action_look *l);

/* Answers of the store: status is 0, or of sysexits.h with a text.  sequence is
 * that of the action: an answer is ignored if its job was deleted and another
 * job has the id. */
/* To ACT_JOB_OPEN. */
void coord_job_opened(struct coord *c, uint64_t now_ms,
                      const uint8_t job[MSG_JOB], uint64_t sequence, int status,
                      const char *text);
/* To ACT_JOB_OPEN, before coord_job_opened(): there is no room for the job's
 * rows yet, so this job is held. */
void coord_job_waits(struct coord *c, uint64_t now_ms,
                     const uint8_t job[MSG_JOB], uint64_t sequence,
                     const char *text);
/* To ACT_PUT_ROWS, in the order of these actions. */
void coord_rows_stored(struct coord *c, uint64_t now_ms,
                       const struct action_rows *key, int status,
                       const char *text);
/* To ACT_WRITE_PICTURE. */
void coord_picture_written(struct coord *c, uint64_t now_ms,
                           const uint8_t job[MSG_JOB], uint64_t sequence,
                           uint32_t frame, int status, const char *text);
/* To ACT_SETTLE: all earlier changes are on the disk. */
void coord_settled(struct coord *c, uint64_t now_ms, uint64_t conn,
                   uint32_t request);
/* To ACT_JOB_END and ACT_DROP_CACHE: the size of the job's folder, and of the
 * ambient cache that is kept in it. */
void coord_job_filed(struct coord *c, uint64_t now_ms,
                     const uint8_t job[MSG_JOB], uint64_t sequence,
                     uint64_t bytes, uint64_t cache_bytes);
/* To ACT_LOAD_CACHE. */
void coord_cache_came(struct coord *c, uint64_t now_ms,
                      const uint8_t job[MSG_JOB], uint64_t sequence,
                      const struct saved_cache *cache);

/* ACT_SEND_PICTURE has sent all of its answer, or failed. */
void coord_sent(struct coord *c, uint64_t conn);

/* Hashes of all files that may not be deleted: the files of all jobs, files
 * that wait for a job, and files of offers of which others still come.  There
 * are *n, malloc'd, in any order, some perhaps more than once; NULL: memory is
 * out. */
uint8_t *coord_files(const struct coord *c, size_t *n);

/* The disk has become full, so all jobs are held; or it has room again.  text
 * says why. */
void coord_fullness(struct coord *c, uint64_t now_ms, bool full,
                    const char *text);

/* The worker of that name is no longer welcome, connected or not: tell the
 * other workers of its jobs to end their links with it, each as soon as it is
 * there; until the worker says HELLO again.  The shell closes its connection.
 */
void coord_expel(struct coord *c, uint64_t now_ms, const char *name);

/* Time has passed; call it about every 100 ms. */
void coord_tick(struct coord *c, uint64_t now_ms);

/* --- for the shell to ask --- */

/* Set *out to all that the store keeps of a job but its frames and units;
 * false: there is no such job.  Pointers of *out are valid until the next
 * event. */
bool coord_saved(const struct coord *c, const uint8_t job[MSG_JOB],
                 struct saved_job *out);

#endif
