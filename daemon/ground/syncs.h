/* syncs.h - files that were written and closed, and have yet to last
 *
 * A file system that is asked to make a new file last writes all that it has
 * noted meanwhile; so of many small files one after the other each takes as
 * long as all of them take together, once writing has begun for all.
 * A write that failed after its file was closed is told to whoever opens the
 * file next and syncs it (Linux 4.16).
 * All calls may wait for the disk.
 * Thread: one at a time. */
#ifndef DAEMON_SYNCS_H
#define DAEMON_SYNCS_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* Zeroed, there is none. */
struct syncs {
    struct syncs_file *file;
    size_t n;
};

/* The file is to last; named: and its name, which is new. */
int syncs_add(struct syncs *s, const char *path, bool named,
              struct rad_error *err);

/* Wait until all of them do.  Those that are not there any more do not matter.
 * There is none afterwards, whatever came of it. */
int syncs_settle(struct syncs *s, struct rad_error *err);

void syncs_release(struct syncs *s);

/* Begin to write what is in that open file, and do not wait for it. */
void syncs_begin(int fd);

#endif
