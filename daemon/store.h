/* store.h - what a daemon keeps on disk: files by hash, rows, pictures
 *
 * DIR/lock           one process at a time
 * DIR/files/HASH     files of bundles (blobs.h)
 * DIR/jobs/ID/N.rows pixels of frame N as they come (rows.h)
 * DIR/jobs/ID/N.hdr  its picture, N.z its distances, once it is complete
 *
 * Files outlive the daemon, jobs do not: their folders go when a store opens.
 *
 * Writing is done by one thread of libuv's pool, in order (task.h); each
 * request ends in one call of the handler, on the loop.  Unless the store is
 * volatile, what a handler hears of is on the disk: rows that wait together
 * share one fdatasync.
 * Thread: all calls on the loop's. */
#ifndef RADD_DAEMON_STORE_H
#define RADD_DAEMON_STORE_H

#include "action.h"
#include "coord.h"

#include <uv.h>

/* status: 0, or of sysexits.h with a text. */
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
};

/* What can be read back: a file by its hash, or a job's picture. */
struct store_source {
    bool file; /* hash counts, else job, frame and what */
    uint8_t hash[MSG_HASH];
    uint8_t job[MSG_JOB];
    uint32_t frame;
    enum msg_what what; /* PICTURE, DEPTH or PREVIEW */
};

struct store;

/* NULL with *err set: the folder cannot be made, or is another's.  durable:
 * wait for the disk. */
struct store *store_open(uv_loop_t *loop, const char *dir, bool durable,
                         const struct store_handler *handler, void *arg,
                         struct rad_error *err);

/* Nothing waits for the disk. */
bool store_idle(const struct store *s);
/* Bytes that wait to be written: what should slow their senders down. */
size_t store_backlog(const struct store *s);
/* Only when idle. */
void store_close(struct store *s);

const char *store_files_dir(const struct store *s);

/* Is the file there, and is it what its name says?  A damaged one is removed;
 * see sound.h. */
bool store_has_file(struct store *s, const uint8_t hash[MSG_HASH]);

/* Append a piece of the file that `conn` sends. */
void store_put_chunk(struct store *s, uint64_t conn,
                     const struct msg_chunk *chunk);
/* Forget what conn sent by halves. */
void store_drop_conn(struct store *s, uint64_t conn);

/* Make room for the job's rows; what is in *saved is copied. */
void store_open_job(struct store *s, const uint8_t job[MSG_JOB],
                    const struct saved_job *saved);
void store_put_rows(struct store *s, const struct action_rows *rows);
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
