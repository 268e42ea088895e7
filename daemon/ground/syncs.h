/* syncs.h - files that were written and closed, and have yet to last
 *
 * fsync() of a new file makes the file system write all that it has noted.  So
 * many small files are begun first (syncs_begin()), then synced.
 * If the system fails to write a file after it was closed, the next sync of the
 * file, opened again, gets the error (Linux 4.16).
 * All calls may wait for the disk.
 * Thread: one at a time. */
#ifndef DAEMON_SYNCS_H
#define DAEMON_SYNCS_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* Zeroed, no file is noted. */
struct syncs {
    struct syncs_file *file;
    size_t n;
};

/* Note a closed file that syncs_settle() is to sync; named: its name is new, so
 * sync its folder, too.  path is copied.  RAD_ENOMEM. */
int syncs_add(struct syncs *s, const char *path, bool named,
              struct rad_error *err);

/* Sync all noted files, and forget them whether that fails or not; files that
 * are gone are skipped. */
int syncs_settle(struct syncs *s, struct rad_error *err);

/* Forget all noted files. */
void syncs_release(struct syncs *s);

/* Begin to write the bytes of an open file, and do not wait. */
void syncs_begin(int fd);

#endif
