/* sound.h - which files of a store hold what their names say
 *
 * A file is named by its SHA-256.  It is read and compared with its name when
 * this process first meets it, and again when its length or time has changed.
 * Reading takes about a second for a gigabyte, once.  Of very many files those
 * that were noted first are forgotten, and read again when somebody asks.
 * Thread: the loop's, but where another is named. */
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

/* Is the file at path there, and is its digest that?  *damaged says that it
 * is another. */
bool sounds_check(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                  const char *path, bool *damaged);

/* The same, with the reason: RAD_EDATA where it is missing or damaged,
 * RAD_EPERM, RAD_EIO. */
int sounds_require(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                   const char *path, struct rad_error *err);

/* Would sounds_check() answer at once? */
bool sounds_known(const struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                  const char *path);

/* Read the file at path: 1: its digest is that; 0: another; -1: that cannot be
 * told.  Any thread. */
int sounds_read(const uint8_t digest[RAD_SHA_BYTES], const char *path);

/* The file at path has just been written, and its digest was that. */
void sounds_note(struct sounds *s, const uint8_t digest[RAD_SHA_BYTES],
                 const char *path);

#endif
