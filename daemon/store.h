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

#include "action.h"
#include "coord.h"

#include <uv.h>

#define STORE_DATABASE "radcoord.db"

/* status: 0, or of sysexits.h with a text.  A store without `job` has no
 * jobs. */
struct store_handler {
    /* store_put_chunk() made a file whole, or failed. */
    void (*file)(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH],
                 int status, const char *text);
    void (*job)(void *arg, const uint8_t job[MSG_JOB], int status,
                const char *text);
    void (*rows)(void *arg, const struct action_rows *key, int status,
                 const char *text);
    void (*picture)(void *arg, const uint8_t job[MSG_JOB], uint32_t frame,
                    int status, const char *text);
    /* Part of a file is written and store_backlog() smaller, with none of the
     * above to be told; may be NULL. */
    void (*progress)(void *arg);
    /* The store does not do what it should, and never will: memory is out, or
     * the disk of a durable store failed.  Nothing that was asked for and not
     * answered is kept. */
    void (*broken)(void *arg, int status, const char *text);
    /* The end of a job is kept; its folder has so many bytes. */
    void (*filed)(void *arg, const uint8_t job[MSG_JOB], uint64_t bytes);
    void (*settled)(void *arg, uint64_t conn, uint32_t request);
    /* store_look() has looked. */
    void (*looked)(void *arg, const struct action_look *l);
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

/* Is the file there, and is it what its name says?  A damaged one is removed;
 * see sound.h. */
bool store_has_file(struct store *s, const uint8_t hash[MSG_HASH]);

/* Remove the files that are none of these n, and that nobody has asked for
 * (store_has_file) or sent for STORE_FILES_S.  hashes rise, and are taken. */
#define STORE_FILES_S (24 * 3600)
void store_sweep(struct store *s, uint8_t *hashes, size_t n);

/* Is it known of each of the files, or are they missing?  If not they are read
 * on another thread, and looked() follows; then store_has_file() answers at
 * once. */
bool store_look(struct store *s, const struct action_look *l);

/* Append a piece of the file that `conn` sends. */
void store_put_chunk(struct store *s, uint64_t conn,
                     const struct msg_chunk *chunk);
/* Forget what conn sent by halves. */
void store_drop_conn(struct store *s, uint64_t conn);

/* Keep the job, and make room for its rows; what is in *saved is copied. */
void store_open_job(struct store *s, const uint8_t job[MSG_JOB],
                    const struct saved_job *saved);
void store_put_state(struct store *s, const uint8_t job[MSG_JOB], int state);
void store_end_job(struct store *s, const struct saved_job *saved,
                   const void *stats, size_t len);
void store_keep_unit(struct store *s, const uint8_t job[MSG_JOB],
                     const struct saved_unit *unit);
void store_put_rows(struct store *s, const struct action_rows *rows);
/* Call settled() when all that was asked for so far is kept. */
void store_settle(struct store *s, uint64_t conn, uint32_t request);
void store_write_picture(struct store *s, const uint8_t job[MSG_JOB],
                         uint32_t frame);
void store_forget_job(struct store *s, const uint8_t job[MSG_JOB]);

/* Copy up to cap bytes from `offset` on into buf and call fn, with the number
 * of bytes and the source's whole size, or a negative n and a text.  A
 * preview is made at offset 0. */
typedef void store_read_fn(void *arg, ssize_t n, uint64_t size,
                           const char *text);
void store_read(struct store *s, const struct store_source *from,
                uint64_t offset, void *buf, size_t cap, store_read_fn *fn,
                void *arg);

#endif
