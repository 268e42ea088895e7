/* sound.h - which files of a store hold what their names say
 *
 * A file is named by its SHA-256.  It is read and compared with its name when
 * this process first checks it, and again when its length or time has changed.
 * It is synced, too: a process that was killed may have left it unsynced.
 * Reading takes about a second for a gigabyte.  Beyond SOUND_MOST files those
 * that were noted first are forgotten, and read again at their next check.
 * Thread: the loop's, unless another is named. */
#ifndef RADD_DAEMON_SOUND_H
#define RADD_DAEMON_SOUND_H

#include "base/sha.h"

#include <stdint.h>

#define SOUND_BUCKETS 256
#define SOUND_MOST    65536 /* files that are remembered */

struct sound; /* one file */

/* Zeroed, it knows no file. */
struct sounds {
    struct sound *bucket[SOUND_BUCKETS]; /* the newest first */
    unsigned n[SOUND_BUCKETS];
};

void sounds_release(struct sounds *s);

/* Is the file at path there, and has it that digest?  *damaged: it is there,
 * and has another. */
bool sounds_check(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                  const char *path, bool *damaged);

/* Check as sounds_check(), with an error: RAD_EDATA if the file is missing or
 * damaged, RAD_EPERM, RAD_EIO. */
int sounds_require(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                   const char *path, struct rad_error *err);

/* Would sounds_check() answer without reading the file? */
bool sounds_known(const struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                  const char *path);

/* Read and sync the file at path.  1: it has that digest; 0: it has another;
 * -1: it cannot be read or synced, or memory is out.  Thread: any. */
int sounds_read(const uint8_t digest[RAD_SHA_BYTES], const char *path);

/* Note that the file at path has just been written, and has that digest. */
void sounds_note(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                 const char *path);

#endif
