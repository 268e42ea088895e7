/* store_read.h - files and pictures of the store, read piece by piece
 *
 * Thread: the loop's. */
#ifndef RADD_DAEMON_STORE_READ_H
#define RADD_DAEMON_STORE_READ_H

#include "store/store.h"

/* What is read: a scene's file, by its hash; or a picture or another file of a
 * job. */
struct store_source {
    bool file; /* a scene's file, by hash; else by job, frame and what */
    uint8_t hash[MSG_HASH];
    uint8_t job[MSG_JOB];
    uint32_t frame;
    enum msg_what what;
};

/* How far a file has been read by store_read(); zeroed at first but for from.
 */
struct store_reading {
    struct store_source from;
    uint64_t offset;     /* bytes that were read so far */
    uint64_t size;       /* of the whole file; every piece finds the same */
    struct mark mark;    /* of the file, if the database has one */
    struct rad_sha sha;  /* of the bytes that were read, while hashing */
    bool hashing;        /* the file is compared with its mark */
    int preview;         /* descriptor of a preview, if `store` is set */
    struct store *store; /* whose count of open previews has this preview */
};

/* Copy the next bytes, up to cap, into buf, which must last until fn is called
 * on the loop.  fn gets n, the number of these bytes, and the size of the whole
 * file; or n < 0 with a status of sysexits.h and a text.  If the database has
 * the file's mark the last piece comes only if the whole file has that hash.
 * A preview is made when its first piece is read.  Meanwhile another preview of
 * the frame, or its picture, may take its place, so its file stays open: all
 * pieces are of the same file.  Few previews may be open at a time; another
 * fails as RAD_ETEMPFAIL does. */
typedef void store_read_fn(void *arg, ssize_t n, uint64_t size, int status,
                           const char *text);
void store_read(struct store *s, struct store_reading *r, void *buf, size_t cap,
                store_read_fn *fn, void *arg);
/* Release what reading holds.  Call it in any case, also after the last piece.
 */
void store_reading_release(struct store_reading *r);

#endif
