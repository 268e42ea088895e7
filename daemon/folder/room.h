/* room.h - room on the disk that is kept for files that are not written yet
 *
 * A file of allocated bytes that mean nothing: it is made shorter as the files
 * are made for which it keeps room.
 * All calls do I/O and may wait for the disk.
 * Thread: any. */
#ifndef DAEMON_ROOM_H
#define DAEMON_ROOM_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

/* Has the file system of dir room for so many bytes more, and some to spare?
 * `what` names the files in the error.  RAD_EFULL: not now; RAD_EDATA: the disk
 * is too small. */
int room_check(const char *dir, uint64_t bytes, const char *what,
               struct rad_error *err);
/* Are the bytes no more than what room_check() spares, or is that not known? */
bool room_is_small(const char *dir, uint64_t bytes);

/* Make the file `bytes` long, and do not sync it; 0: remove it.  RAD_EFULL, or
 * another code of disk.h. */
int room_set(const char *path, uint64_t bytes, struct rad_error *err);

/* Length of the file; 0: there is none. */
uint64_t room_size(const char *path);

#endif
