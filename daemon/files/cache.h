/* cache.h - which files of a folder a worker keeps, and which it removes
 *
 * The folder is that of blobs.h.  Files of the worker's present jobs are in use
 * and stay.  Other files are removed when a new file has no room, below a limit
 * or on the disk: first the files that were used the longest time ago.
 * A file's time of use is its time of access (blobs_touch()), so it outlives
 * the process.  The folder is listed once, at the start.
 *
 * Errors: RAD_EFULL, in words for the machine's administrator; RAD_ENOMEM;
 * codes of disk.h for the folder.
 * cache_arrived(), cache_given_up() and cache_bytes() do no I/O; all other
 * calls do.
 * Thread: one at a time. */
#ifndef RADD_DAEMON_CACHE_H
#define RADD_DAEMON_CACHE_H

#include "files/blobs.h"
#include "proto/message.h"

struct cache;

/* Make a cache of the folder b, which is borrowed.  limit [bytes]; 0: a tenth
 * of the file system.  NULL: memory is out. */
struct cache *cache_new(struct blobs *b, uint64_t limit, struct rad_error *err);
void cache_free(struct cache *c);

/* Set another limit, and remove files that are not in use until the rest lies
 * below it. */
void cache_set_limit(struct cache *c, uint64_t limit);

/* From now on the job uses these files, which have so many bytes together, by
 * its submitter's word.  Make room for those that are missing.  After an error
 * other than RAD_ENOMEM the job uses no files. */
int cache_use(struct cache *c, const uint8_t job[MSG_JOB],
              const struct msg_hashes *files, uint64_t bytes,
              struct rad_error *err);
/* The job uses its files no more.  Unknown jobs are ignored. */
void cache_leave(struct cache *c, const uint8_t job[MSG_JOB]);

/* Make room for a file of `bytes` that begins to arrive.  After 0, exactly one
 * call of cache_arrived() or cache_given_up() with these bytes follows. */
int cache_expect(struct cache *c, uint64_t bytes, struct rad_error *err);
void cache_arrived(struct cache *c, const uint8_t hash[MSG_HASH],
                   uint64_t bytes);
void cache_given_up(struct cache *c, uint64_t bytes);

/* Bytes of the files that are there. */
uint64_t cache_bytes(const struct cache *c);

#endif
