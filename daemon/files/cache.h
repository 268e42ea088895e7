/* cache.h - which files a worker keeps, and for whom it makes room
 *
 * Over the folder of blobs.h: files of jobs that this worker has are in use and
 * stay; of the others, those go first that were used the longest time ago, as
 * soon as there is no room for what is to come: below a limit, and on the disk.
 * Times of use are files' times of access (blobs_touch), so they outlive the
 * process.  What is there is remembered: the folder is listed once, at the
 * start.
 *
 * Errors: RAD_EFULL, in words for whoever looks after the machine, and what the
 * folder fails with, RAD_EIO or RAD_EPERM.
 * All calls but cache_free do I/O.  Thread: one at a time. */
#ifndef RADD_DAEMON_CACHE_H
#define RADD_DAEMON_CACHE_H

#include "files/blobs.h"
#include "proto/message.h"

struct cache;

/* limit [bytes]; 0: a tenth of the file system.  b is borrowed.  NULL with *err
 * set. */
struct cache *cache_new(struct blobs *b, uint64_t limit, struct rad_error *err);
void cache_free(struct cache *c);

/* Another limit; what is above it goes as far as it may. */
void cache_set_limit(struct cache *c, uint64_t limit);

/* A job uses these files from now on, of which all together have so many bytes
 * by what its submitter says: make room for those that are missing.  After an
 * error it uses none. */
int cache_use(struct cache *c, const uint8_t job[MSG_JOB],
              const struct msg_hashes *files, uint64_t bytes,
              struct rad_error *err);
/* The job is over here; one that is not known is fine. */
void cache_leave(struct cache *c, const uint8_t job[MSG_JOB]);

/* A file of that size arrives: make room.  Then, once, it is there, or it is
 * given up. */
int cache_expect(struct cache *c, uint64_t bytes, struct rad_error *err);
void cache_arrived(struct cache *c, const uint8_t hash[MSG_HASH],
                   uint64_t bytes);
void cache_given_up(struct cache *c, uint64_t bytes);

uint64_t cache_bytes(const struct cache *c);

#endif
