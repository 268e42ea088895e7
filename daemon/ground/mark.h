/* mark.h - what a finished file held when it was written: its size and SHA-256
 *
 * The database keeps one for each picture, its distances and the statistics of
 * a job, so what became of a file since is known: at the start of radcoord by
 * its size, by `radctl check` and when it is sent by its bytes.
 * Thread: any; what looks at files does I/O. */
#ifndef DAEMON_MARK_H
#define DAEMON_MARK_H

#include "base/sha.h"


struct mark {
    bool known; /* else the database has none of the file */
    uint64_t size;
    uint8_t hash[RAD_SHA_BYTES];
};

/* Is a file of that size what it was?  RAD_EDATA; path is for the words. */
int mark_check_size(const struct mark *m, uint64_t size, const char *path,
                    struct rad_error *err);
/* Likewise of the digest of all of its bytes, which is released. */
int mark_check_sha(const struct mark *m, struct rad_sha *sha, const char *path,
                   struct rad_error *err);

/* Look at the file at path: is it there, not empty, and of that size; whole:
 * read it, and compare its digest.  RAD_EDATA, RAD_EPERM when it is denied to
 * us, RAD_EIO, RAD_ENOMEM. */
int mark_look(const struct mark *m, const char *path, bool whole,
              struct rad_error *err);

/* That `path` cannot be opened or looked at, of which errno is the reason:
 * RAD_EDATA where it is missing, else as disk_fail(). */
int mark_missing(const char *path, int number, struct rad_error *err);

#endif
