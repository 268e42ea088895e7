/* blobs.h - files named by the SHA-256 of their bytes, in one folder
 *
 * dir/<64 hex digits> is such a file; dir/<number>.part is one that is
 * arriving.  A file gets its name only when all its bytes have come and have
 * that hash, so what is there is right.
 * All calls do I/O and may wait for the disk.
 * Thread: one at a time, but blobs_path() may be called from any. */
#ifndef RADD_DAEMON_BLOBS_H
#define RADD_DAEMON_BLOBS_H

#include "base/error.h"
#include "base/sha.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>
#include <time.h>

#define BLOBS_DIR_MAX 1024

struct blobs {
    char dir[BLOBS_DIR_MAX];
    bool durable;   /* fsync before a file gets its name */
    unsigned parts; /* files begun so far, for their temporary names */
};

/* Make the folder if it is missing, and drop what was half there. */
int blobs_open(struct blobs *b, const char *dir, bool durable,
               struct rad_error *err);

/* dir/<hash>; hash must be rad_sha_valid(). */
#define BLOBS_PATH_MAX (BLOBS_DIR_MAX + RAD_SHA_HEX + 8)
void blobs_path(const struct blobs *b, const char *hash,
                char path[BLOBS_PATH_MAX]);

/* Is there a file in that folder, which may be missing? */
bool blobs_any(const char *dir);

/* Note that somebody wants it. */
void blobs_touch(const struct blobs *b, const char *hash);

/* Remove the files that are none of the n digests at keep, which rise, and that
 * nobody has touched or made since `before`.  Returns how many. */
unsigned blobs_sweep(const struct blobs *b, const uint8_t *keep, size_t n,
                     time_t before);

/* Call fn for each file, in no order, until it fails; names are hashes.  What
 * fn said, or 0. */
typedef int blobs_fn(void *arg, const char *name, const struct stat *st);
int blobs_each(const struct blobs *b, blobs_fn *fn, void *arg);

/* Is it there, and how large? */
bool blobs_size(const struct blobs *b, const uint8_t hash[RAD_SHA_BYTES],
                uint64_t *bytes);

/* Bytes of the file system, and those of them that are free to us, but for
 * quotas; UINT64_MAX where that is not known. */
uint64_t blobs_disk_bytes(const struct blobs *b);
uint64_t blobs_disk_free(const struct blobs *b);
/* Could so many bytes be written now?  RAD_EFULL, or what else fails.  A folder
 * that was removed is made again. */
int blobs_probe(const struct blobs *b, uint64_t bytes, struct rad_error *err);

/* closed -> arriving -> hashed -> named -> closed: the file is there
 *              |           |        \-> closed, with an error
 *              \-----------\-> closed, and its temporary file gone  */
enum blob_state { BLOB_CLOSED, BLOB_ARRIVING, BLOB_HASHED, BLOB_NAMED };

/* A file that is arriving.  It is not open between two writes: a peer may begin
 * as many as it likes.  Zeroed, it is closed. */
struct blob_part {
    struct blobs *blobs;
    unsigned serial;
    char hash[RAD_SHA_HEX + 1];
    uint64_t total, got;
    struct rad_sha sha; /* while it is arriving */
    enum blob_state state;
};

/* RAD_EPROTO for a bad hash. */
int blobs_part_open(struct blob_part *p, struct blobs *b, const char *hash,
                    uint64_t total, struct rad_error *err);

/* Append n bytes, which must be those at offset p->got.  Returns 1 when that
 * completed it: the file is there and p closed.  RAD_EPROTO for bytes out of
 * order, too many, or of another hash; RAD_EIO.  After an error p is closed,
 * but after RAD_EFULL and RAD_ESHORT: then the same bytes may be tried again.
 */
int blobs_part_write(struct blob_part *p, uint64_t offset, const void *data,
                     size_t n, struct rad_error *err);

/* Forget it; a closed one is fine. */
void blobs_part_abort(struct blob_part *p);

#endif
