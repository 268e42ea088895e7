/* store.h - what a daemon keeps on disk: files by hash, jobs, rows, pictures
 *
 * DIR/lock        one process at a time
 * DIR/files/HASH  files of bundles (blobs.h)
 * DIR/jobs/ID/    rows and pictures of a job (folder.h)
 * DIR/radcoord.db what is known of jobs and their units (journal.h)
 *
 * Files outlive the daemon, and so do jobs where the store is durable: then
 * there is a database.  Else the jobs' folders go when a store opens.
 *
 * Writing is done by one thread of libuv's pool, in order (task.h); each
 * request ends in one call of the handler, on the loop.  Where the store is
 * durable, what a handler hears of is on the disk: what is written within a
 * while shares one fdatasync and one commit.  When the disk is full all that
 * writes waits for room; when it fails, the handler hears of nothing any more
 * but that.
 * Thread: all calls on the loop's. */
#ifndef RADD_DAEMON_STORE_H
#define RADD_DAEMON_STORE_H

#include "machine/action.h"
#include "front/coord.h"

#include <uv.h>

/* status: 0, or of sysexits.h with a text.  sequence: as it was asked with.  A
 * store without `job` has no jobs. */
struct store_handler {
    /* store_put_chunk() made a file whole, or failed. */
    void (*file)(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH],
                 int status, const char *text);
    void (*job)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                int status, const char *text);
    /* The job waits for room on the disk; others go on. */
    void (*waits)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                  const char *text);
    void (*rows)(void *arg, const struct action_rows *key, int status,
                 const char *text);
    void (*picture)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                    uint32_t frame, int status, const char *text);
    /* Part of a file is written and store_backlog() smaller, with none of the
     * above to be told; may be NULL. */
    void (*progress)(void *arg);
    /* The store does not do what it should, and never will: memory is out, or
     * the disk of a durable store failed.  Nothing that was asked for and not
     * answered is kept. */
    void (*broken)(void *arg, int status, const char *text);
    /* The end of a job is kept, or store_drop_cache() was done; its folder has
     * so many bytes, and its ambient cache that many of them. */
    void (*filed)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                  uint64_t bytes, uint64_t cache_bytes);
    /* store_load_cache() has read records, which are the handler's now. */
    void (*cache)(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
                  uint8_t *records, size_t len, int status, const char *text);
    void (*settled)(void *arg, uint64_t conn, uint32_t request);
    /* store_recover() met a job that was forgotten; may be NULL. */
    void (*gone)(void *arg, const struct saved_gone *g);
    /* store_look() has looked. */
    void (*looked)(void *arg, const struct action_look *l);
    /* store_read_submit() has read the frames of the message, or failed. */
    void (*submit)(void *arg, uint64_t conn, const struct msg *m, int status,
                   const char *text);
    /* The disk is full, and what writes is held; or it goes on. */
    void (*fullness)(void *arg, bool full, const char *text);
};

/* What can be read back: a file by its hash, or a job's picture. */
struct store_source {
    bool file; /* hash counts, else job, frame and what */
    uint8_t hash[MSG_HASH];
    uint8_t job[MSG_JOB];
    uint32_t frame;
    enum msg_what what;
};

struct store;

/* NULL with *err set: the folder cannot be made, is another's, or is damaged
 * (RAD_EDATA).  durable: wait for the disk, and let jobs outlive the
 * process. */
struct store *store_open(uv_loop_t *loop, const char *dir, bool durable,
                         const struct store_handler *handler, void *arg,
                         struct rad_error *err);

/* Take up what an earlier process left: fn is called for each job that was
 * acknowledged, in that order, and may call store_read_row(), for rows that it
 * is said to have.  *epoch: the number of this life.  Before anything else; it
 * waits for the disk. */
typedef int store_job_fn(void *arg, const struct saved_job *s,
                         struct rad_error *err);
int store_recover(struct store *s, uint64_t now_ms, uint64_t *epoch,
                  store_job_fn *fn, void *arg, struct rad_error *err);
/* fn is called for each worker that an earlier process left drained. */
typedef int store_worker_fn(void *arg, const char *worker,
                            struct rad_error *err);
int store_read_drained(struct store *s, store_worker_fn *fn, void *arg,
                       struct rad_error *err);
bool store_read_row(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame,
                    uint32_t y, uint8_t *pixels);

/* Nothing waits for the disk. */
bool store_idle(const struct store *s);
/* Bytes that wait to be written: what should slow their senders down. */
size_t store_backlog(const struct store *s);
/* Become idle soon: what is held for want of room is given up, and nothing that
 * fails is told any more. */
void store_end(struct store *s);
/* Only when idle; may run the loop. */
void store_close(struct store *s);

const char *store_files_dir(const struct store *s);

/* Look whether the file is there, and is what its name says: a damaged one is
 * removed (sound.h), and the time of another counts as used now. */
bool store_check_file(struct store *s, const uint8_t hash[MSG_HASH]);

/* Remove the files that are none of these n, and that nobody has asked for
 * (store_check_file) or sent for age_s.  hashes are taken. */
void store_sweep(struct store *s, uint8_t *hashes, size_t n, long age_s);

/* A worker's store: files that no job of its uses go, the oldest first, where
 * all together have more bytes than that (0: a tenth of the disk), or the disk
 * has no room for new ones.  First, at the start, when that is done at once; or
 * later, to change it. */
int store_limit(struct store *s, uint64_t bytes, struct rad_error *err);
/* The job that store_look() was called for is over here. */
void store_leave(struct store *s, const uint8_t job[MSG_JOB]);

/* Is it known of each of the files, or are they missing?  If not they are read
 * on another thread, and looked() follows; then store_check_file() answers at
 * once.  With store_limit() it always follows: then l->job has the files from
 * now on, until store_leave(), if there is room for them; else l->status and
 * l->why tell. */
bool store_look(struct store *s, const struct action_look *l);

/* Append a piece of the file that `conn` sends. */
void store_put_chunk(struct store *s, uint64_t conn,
                     const struct msg_chunk *chunk);
/* Forget what conn sent by halves. */
void store_drop_conn(struct store *s, uint64_t conn);
/* Read the frames of a SUBMIT that has them in a file, and hand a copy that has
 * them to submit().  False: one of that connection is being read. */
bool store_read_submit(struct store *s, uint64_t conn, const struct msg *m);
/* Keep the job, and make room for its rows; what is in *saved is copied. */
void store_open_job(struct store *s, const uint8_t job[MSG_JOB],
                    const struct saved_job *saved);
void store_put_state(struct store *s, const uint8_t job[MSG_JOB], int state,
                     int32_t priority);
/* An admin drained the worker, or had enough of that. */
void store_put_drained(struct store *s, const char *worker, bool drained);
/* Takes its statistics, malloc'd and of len bytes. */
void store_end_job(struct store *s, const struct saved_job *saved, char *stats,
                   size_t len);
void store_keep_unit(struct store *s, const uint8_t job[MSG_JOB],
                     const struct saved_unit *unit);
/* Keep a pass's records, copied, if there is room: nothing follows. */
void store_put_pass(struct store *s, const uint8_t job[MSG_JOB], uint32_t pass,
                    const struct saved_pass *saved);
/* Colours to be shown in previews, which are copied: nothing follows. */
void store_put_colours(struct store *s, const uint8_t job[MSG_JOB],
                       const struct action_colours *colours);
/* Read the records that the job begins with, then cache(); or have the cache
 * that is kept of a job that is over go, then filed(). */
void store_load_cache(struct store *s, const uint8_t job[MSG_JOB],
                      uint64_t sequence);
void store_drop_cache(struct store *s, const uint8_t job[MSG_JOB],
                      uint64_t sequence);
/* Make the job's pictures with these options, which are copied, from now on. */
void store_set_options(struct store *s, const uint8_t job[MSG_JOB],
                       const char *options);
void store_put_rows(struct store *s, const struct action_rows *rows);
/* Call settled() when all that was asked for so far is kept. */
void store_settle(struct store *s, uint64_t conn, uint32_t request);
void store_write_picture(struct store *s, const uint8_t job[MSG_JOB],
                         uint64_t sequence, uint32_t frame);
/* The picture of a frame was fetched by its owner. */
void store_note_fetched(struct store *s, const uint8_t job[MSG_JOB],
                        uint32_t frame);
void store_forget_job(struct store *s, const struct saved_gone *gone);
/* A file on its way out: zeroed but for what is wanted of it. */
struct store_reading {
    struct store_source from;
    uint64_t offset; /* what was read of it so far */
    struct mark mark;
    struct rad_sha sha; /* while it is held against its mark */
    bool hashing;
};

/* Copy up to cap bytes that follow into buf and call fn, with the number of
 * bytes and the whole size, or a negative n, a status of sysexits.h and a text.
 * The last bytes come only if all were what the database says.  A preview is
 * made with the first. */
typedef void store_read_fn(void *arg, ssize_t n, uint64_t size, int status,
                           const char *text);
void store_read(struct store *s, struct store_reading *r, void *buf, size_t cap,
                store_read_fn *fn, void *arg);
/* Whether it was read to its end or not. */
void store_reading_release(struct store_reading *r);

#endif
