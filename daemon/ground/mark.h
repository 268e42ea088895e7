/* mark.h - what a finished file held when it was written: its size and SHA-256
 *
 * The database keeps a mark of each picture, its distances and the statistics
 * of a job.  So a file that has changed is found: by its size when radcoord
 * starts, by its bytes when the file is sent or by `radctl check`.
 * Thread: any; mark_look() does I/O. */
#ifndef DAEMON_MARK_H
#define DAEMON_MARK_H

#include "base/sha.h"


struct mark {
    bool known; /* false: the database has no mark of the file */
    uint64_t size;
    uint8_t hash[RAD_SHA_BYTES];
};

/* Has the file its marked size?  RAD_EDATA: it has another, or is empty.  path
 * is named in the error. */
int mark_check_size(const struct mark *m, uint64_t size, const char *path,
                    struct rad_error *err);
/* Has the file, all of whose bytes are in sha, the marked digest?  RAD_EDATA:
 * it has another.  sha is released. */
int mark_check_sha(const struct mark *m, struct rad_sha *sha, const char *path,
                   struct rad_error *err);

/* Check that the file at path is there and has its marked size; whole: read it,
 * and compare its digest.  RAD_EDATA: the file is missing, empty or another.
 * Or RAD_ENOMEM, or a code of disk.h. */
int mark_look(const struct mark *m, const char *path, bool whole,
              struct rad_error *err);

/* Set *err for a `path` that could not be opened, for reason `number` (errno).
 * RAD_EDATA if the file is missing, else as disk_fail(). */
int mark_missing(const char *path, int number, struct rad_error *err);

#endif
