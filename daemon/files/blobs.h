/* blobs.h - files named by the SHA-256 of their bytes, in one folder
 *
 * dir/<64 hex digits> is such a file; dir/<number>.part is a file that is
 * arriving.  A file gets its name only when all its bytes are there and have
 * that hash.  Neither bytes nor name are synced, so after a loss of power a
 * file may have a hash that is not its name; but if there is a file of that
 * name, a job may need it, and the bytes that take its place are synced before.
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
    unsigned parts; /* files begun so far, for their temporary names */
};

/* Make the folder if it is missing, and remove files that were arriving in an
 * earlier life. */
int blobs_open(struct blobs *b, const char *dir, struct rad_error *err);

/* dir/<hash>; hash must be rad_sha_valid(). */
#define BLOBS_PATH_MAX (BLOBS_DIR_MAX + RAD_SHA_HEX + 8)
void blobs_path(const struct blobs *b, const char *hash,
                char path[BLOBS_PATH_MAX]);

/* Has the folder dir any file with a hash for its name?  False also if there is
 * no such folder. */
bool blobs_any(const char *dir);

/* Note that the file is used now. */
void blobs_touch(const struct blobs *b, const char *hash);

/* Remove the files whose hashes are none of the n digests at keep, which rise,
 * and that were neither touched nor made in the last age_s seconds.  Returns
 * how many. */
unsigned blobs_sweep(const struct blobs *b, const uint8_t *keep, size_t n,
                     long age_s);

/* Call fn for each file, in no order, until fn returns other than 0; `name` is
 * the file's hash.  Returns fn's last result, or 0. */
typedef int blobs_fn(void *arg, const char *name, const struct stat *st);
int blobs_each(const struct blobs *b, blobs_fn *fn, void *arg);

/* Is the file there?  *bytes gets its length, or 0. */
bool blobs_size(const struct blobs *b, const uint8_t hash[RAD_SHA_BYTES],
                uint64_t *bytes);

/* Bytes of the file system; those of them that are free to us, but for quotas.
 * UINT64_MAX: not known. */
uint64_t blobs_disk_bytes(const struct blobs *b);
uint64_t blobs_disk_free(const struct blobs *b);
/* Could so many bytes be written now?  Allocates them for a moment, and makes
 * the folder again if it was removed.  RAD_EFULL, or another code of disk.h. */
int blobs_probe(const struct blobs *b, uint64_t bytes, struct rad_error *err);

/* closed -> arriving -> hashed -> closed: the file is there
 *              \-----------\-> closed, and its temporary file gone  */
enum blob_state { BLOB_CLOSED, BLOB_ARRIVING, BLOB_HASHED };

/* A file that is arriving.  It is not open between two writes, for a peer may
 * begin any number of files.  Zeroed, it is in BLOB_CLOSED. */
struct blob_part {
    struct blobs *blobs;
    unsigned serial;
    char hash[RAD_SHA_HEX + 1];
    uint64_t total, got; /* bytes of the file; bytes that are here */
    struct rad_sha sha;  /* in BLOB_ARRIVING */
    enum blob_state state;
};

/* Begin a file of `total` bytes.  RAD_EPROTO: hash is not rad_sha_valid(). */
int blobs_part_open(struct blob_part *p, struct blobs *b, const char *hash,
                    uint64_t total, struct rad_error *err);

/* Append n bytes, which must be those at offset p->got.  Returns 1 when the
 * file is complete: it has its name, and p is closed.  RAD_EPROTO for bytes out
 * of order, too many, or of another hash; or a code of disk.h.  After RAD_EFULL
 * and RAD_ESHORT the same bytes may be tried again; other errors close p. */
int blobs_part_write(struct blob_part *p, uint64_t offset, const void *data,
                     size_t n, struct rad_error *err);

/* Close p, and remove its temporary file; nothing if p is closed. */
void blobs_part_abort(struct blob_part *p);

#endif
