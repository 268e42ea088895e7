/* room.h - room on the disk that is kept for what is not written yet
 *
 * A file of so many bytes, which lie on the disk and hold nothing: as other
 * files are made for which it stands, it becomes shorter.
 * All calls do I/O and may wait for the disk.
 * Thread: any. */
#ifndef DAEMON_ROOM_H
#define DAEMON_ROOM_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

/* Has the file system that dir is on room for so many bytes more, which `what`
 * need, with some to spare for others?  RAD_EFULL: not now; RAD_EDATA: it never
 * will. */
int room_check(const char *dir, uint64_t bytes, const char *what,
               struct rad_error *err);
/* Are that many bytes no more than what is spared for others? */
bool room_is_small(const char *dir, uint64_t bytes);

/* Make the file as long as that, of 0 bytes none; what it grows by lasts, but
 * for its name.  RAD_EFULL. */
int room_set(const char *path, uint64_t bytes, struct rad_error *err);

/* Bytes that it is long; 0: there is none. */
uint64_t room_size(const char *path);

#endif
