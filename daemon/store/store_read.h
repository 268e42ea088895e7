/* store_read.h - files and pictures of the store, read piece by piece
 *
 * Thread: the loop's. */
#ifndef RADD_DAEMON_STORE_READ_H
#define RADD_DAEMON_STORE_READ_H

#include "store/store.h"

/* What is read: a file by its hash, or a picture, say, of a job. */
struct store_source {
    bool file; /* read by hash; else by job, frame and what */
    uint8_t hash[MSG_HASH];
    uint8_t job[MSG_JOB];
    uint32_t frame;
    enum msg_what what;
};

/* The state of reading one file by store_read(); all but `from` begins as 0. */
struct store_reading {
    struct store_source from;
    uint64_t offset; /* bytes that were read so far */
    struct mark mark;
    struct rad_sha sha; /* of these bytes, while hashing */
    bool hashing;
    int preview;         /* open file of a preview, if `store` is set */
    struct store *store; /* counts it */
};

/* Copy the next bytes, up to cap, into buf.  fn gets their number and the whole
 * file's size, or a negative n with a status of sysexits.h and a text.  The
 * last piece comes only if the whole file has the hash that the database has
 * noted.  A preview is made when its first piece is read; then other previews
 * of the frame, or its picture, may take its place, but all pieces are of one
 * file.  So its file stays open, and few may at a time: RAD_ETEMPFAIL. */
typedef void store_read_fn(void *arg, ssize_t n, uint64_t size, int status,
                           const char *text);
void store_read(struct store *s, struct store_reading *r, void *buf, size_t cap,
                store_read_fn *fn, void *arg);
/* Must be called whether the file was read to its end or not. */
void store_reading_release(struct store_reading *r);

#endif
