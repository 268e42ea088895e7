/* store.h - what a daemon keeps on disk: files by hash, jobs, rows, pictures
 *
 * DIR/lock        one process at a time
 * DIR/files/HASH  files of bundles (blobs.h)
 * DIR/jobs/ID/    rows and pictures of a job (folder.h)
 * DIR/radcoord.db the database of jobs and their units (journal.h)
 *
 * Files outlive the daemon.  Jobs outlive it only in a durable store, which has
 * a database; any other store removes all jobs' folders when it opens.
 *
 * A thread of libuv's pool carries out the requests in order, as tasks
 * (task.h).  Most requests end in a call of the handler, on the loop.  In a
 * durable store that call comes when the data are on the disk: writes that come
 * close together share one sync of each file and one commit.  While the disk is
 * full all tasks that write wait.  When the disk fails broken() is called, and
 * no other function of the handler after it.  A request for which there is no
 * memory ends the daemon at once, before a later request is kept that stands on
 * it: a unit's number follows that of the unit before.
 * Thread: all calls on the loop's. */
#ifndef RADD_DAEMON_STORE_H
#define RADD_DAEMON_STORE_H

#include "machine/action.h"

#include <uv.h>

/* A status is 0, or of sysexits.h with a text; sequence is that of the request.
 * The handler of a store without jobs leaves `job` NULL. */
struct store_handler {
    /* store_put_chunk() has completed a file, or failed. */
    void (*file)(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH],
                 int status, const char *text);
    /* store_open_job() has kept the job and made room, or failed. */
    void (*job)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                int status, const char *text);
    /* store_open_job() waits for room on the disk; other jobs go on. */
    void (*waits)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                  const char *text);
    /* store_put_rows(), store_write_picture() is done, or failed. */
    void (*rows)(void *arg, const struct action_rows *key, int status,
                 const char *text);
    void (*picture)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                    uint32_t frame, int status, const char *text);
    /* A piece of a file that is not complete yet is written, so store_backlog()
     * is smaller.  May be NULL. */
    void (*progress)(void *arg);
    /* The store has stopped for good: the disk of a durable store failed.
     * Requests without an answer so far are lost. */
    void (*broken)(void *arg, int status, const char *text);
    /* store_end_job() or store_drop_cache() is done.  bytes: size of the job's
     * folder; cache_bytes: of these, the job's ambient cache. */
    void (*filed)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                  uint64_t bytes, uint64_t cache_bytes);
    /* store_load_cache() has read the records, or failed. */
    void (*cache)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                  const struct saved_cache *cache);
    /* store_settle(): all requests before it are on the disk. */
    void (*settled)(void *arg, uint64_t conn, uint32_t request);
    /* store_recover() found a job that was forgotten; may be NULL. */
    void (*gone)(void *arg, const struct saved_gone *g);
    /* store_look() is done. */
    void (*looked)(void *arg, const struct action_look *l);
    /* store_read_submit() has read the frames of the message, or failed. */
    void (*submit)(void *arg, uint64_t conn, const struct msg *m, int status,
                   const char *text);
    /* The disk has become full, so tasks that write wait; or has room again. */
    void (*fullness)(void *arg, bool full, const char *text);
};

struct store;

/* Returns NULL with *err set if the folder cannot be made, belongs to another
 * process, or is damaged (RAD_EDATA).  durable: jobs outlive the process. */
struct store *store_open(uv_loop_t *loop, const char *dir, bool durable,
                         const struct store_handler *handler, void *arg,
                         struct rad_error *err);

/* Begin a life of the coordinator, with this number, before all other requests.
 * *date_ms is the system's clock, which may be wrong (journal.h). */
int store_begin_life(struct store *s, uint64_t *date_ms, uint64_t *epoch,
                     struct rad_error *err);
/* Note the date, every hour or so. */
void store_note_date(struct store *s, uint64_t date_ms);
/* Take up the jobs of earlier processes, before all other requests; waits for
 * the disk, but not for room on it.  fn is called for each job that the
 * database has, in the order in which the jobs were accepted, and may read rows
 * of units in *s with store_read_row(). */
typedef int store_job_fn(void *arg, const struct saved_job *s,
                         struct rad_error *err);
int store_recover(struct store *s, uint64_t now_ms, store_job_fn *fn, void *arg,
                  struct rad_error *err);
/* Call fn for each worker that an earlier process left drained; before
 * store_recover(). */
typedef int store_worker_fn(void *arg, const char *worker,
                            struct rad_error *err);
int store_read_drained(struct store *s, store_worker_fn *fn, void *arg,
                       struct rad_error *err);
bool store_read_row(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame,
                    uint32_t y, uint8_t *pixels);

/* Does no task wait or run, nor its call of the handler? */
bool store_idle(const struct store *s);
/* Bytes that wait to be written.  While they are many their senders should be
 * slowed down. */
size_t store_backlog(const struct store *s);
/* Become idle soon: tasks that are held for want of room are given up, and the
 * handler hears of no failure any more. */
void store_end(struct store *s);
/* Close an idle store; may run the loop. */
void store_close(struct store *s);

const char *store_files_dir(const struct store *s);

/* Is the file there, and does its content have this hash?  A damaged file is
 * removed (sound.h).  At a coordinator the time of a sound file is set to now.
 */
bool store_check_file(struct store *s, const uint8_t hash[MSG_HASH]);

/* Remove all files but the n with these hashes, and files that were written,
 * read or checked (store_check_file()) within age_s seconds.  Takes hashes. */
void store_sweep(struct store *s, uint8_t *hashes, size_t n, long age_s);

/* Make the store a worker's.  When all files together have more than `bytes`
 * (0: a tenth of the disk), or the disk has no room for a new file, files that
 * no job of this worker uses are removed, the least recently used first.  The
 * first call, at the start, acts at once; a later call changes the limit, by a
 * task. */
int store_limit(struct store *s, uint64_t bytes, struct rad_error *err);
/* The job of a store_look() is over at this worker: it uses its files no more.
 */
void store_leave(struct store *s, const uint8_t job[MSG_JOB]);

/* Look whether the files are there and sound.  True: the store knows already,
 * so store_check_file() will read no file, and looked() is not called.  False:
 * a task reads the files, and looked() follows.
 * In a worker's store looked() always follows.  The files are then in use by
 * l->job until store_leave(), if there is room for them; else l->status and
 * l->why tell why not. */
bool store_look(struct store *s, const struct action_look *l);

/* Append a piece to the file that the connection sends. */
void store_put_chunk(struct store *s, uint64_t conn,
                     const struct msg_chunk *chunk);
/* Drop the incomplete files that the connection sent. */
void store_drop_conn(struct store *s, uint64_t conn);
/* Read the frames of a SUBMIT that has them in a file; submit() gets a copy
 * with them.  False: another SUBMIT of this connection is being read. */
bool store_read_submit(struct store *s, uint64_t conn, const struct msg *m);
/* Keep the job and make room for its rows; copies all of *saved. */
void store_open_job(struct store *s, const uint8_t job[MSG_JOB],
                    const struct saved_job *saved);
/* Keep the job's state, of enum job_state, and its priority. */
void store_put_state(struct store *s, const uint8_t job[MSG_JOB], int state,
                     int32_t priority);
/* Keep whether an administrator has drained the worker. */
void store_put_drained(struct store *s, const char *worker, bool drained);
/* Keep how the job ended, and its statistics: stats, len bytes, malloc'd and
 * taken.  filed() follows. */
void store_end_job(struct store *s, const struct saved_job *saved, char *stats,
                   size_t len);
/* Keep a unit that goes out. */
void store_keep_unit(struct store *s, const uint8_t job[MSG_JOB],
                     const struct saved_unit *unit);
/* Keep a copy of a pass's records, if there is room; no call of the handler. */
void store_put_pass(struct store *s, const uint8_t job[MSG_JOB], uint32_t pass,
                    const struct saved_pass *saved);
/* Keep a copy of colours for previews; no call of the handler. */
void store_put_colours(struct store *s, const uint8_t job[MSG_JOB],
                       const struct action_colours *colours);
/* Read the records that the job begins with; cache() follows.  Or remove the
 * cache that is kept of a job that is over; filed() follows. */
void store_load_cache(struct store *s, const uint8_t job[MSG_JOB],
                      uint64_t sequence);
void store_drop_cache(struct store *s, const uint8_t job[MSG_JOB],
                      uint64_t sequence);
/* Put these options, which are copied, into the job's pictures from now on. */
void store_set_options(struct store *s, const uint8_t job[MSG_JOB],
                       const char *options);
/* Keep a copy of the rows; rows() follows. */
void store_put_rows(struct store *s, const struct action_rows *rows);
/* Call settled() when all requests so far are on the disk. */
void store_settle(struct store *s, uint64_t conn, uint32_t request);
/* Make the frame's picture of its rows; picture() follows. */
void store_write_picture(struct store *s, const uint8_t job[MSG_JOB],
                         uint64_t sequence, uint32_t frame);
/* Note that the owner has fetched the frame. */
void store_note_fetched(struct store *s, const uint8_t job[MSG_JOB],
                        uint32_t frame);
/* Remove the job's files, and keep a record of it as forgotten. */
void store_forget_job(struct store *s, const struct saved_gone *gone);

#endif
