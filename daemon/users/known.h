/* known.h - which files of the store one user may know to be there
 *
 * The files of all users' scenes lie in one folder, each file once, by its
 * SHA-256.  A user must not learn that another user has sent a file, and the
 * hash of a file gives no right to it.  So a user may know of a file only while
 * a job of that user has it, from when all files of the job are here until the
 * job is forgotten; and for coord_limits.upload_ms after that, or after the
 * user sent or offered the file.
 *
 * A set of hashes, open addressing.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_KNOWN_H
#define DAEMON_KNOWN_H

#include "proto/message.h"

/* Most files of a user that no job of the user has; when there are more the
 * oldest are forgotten. */
#define KNOWN_MOST 65536

struct known_file;

/* The files of one user; zeroed: no files. */
struct known {
    struct known_file *slots;
    size_t nslots; /* a power of 2, or 0 */
    size_t n;      /* files in the set */
    size_t nfree;  /* of these, files that no job of the user has */
};

void known_release(struct known *k);

/* May the user know of the file? */
bool known_has(const struct known *k, const uint8_t hash[MSG_HASH]);

/* Note that the user sent the whole file, or offered a file that the user may
 * know of.  False: memory is out. */
bool known_sent(struct known *k, uint64_t now_ms, const uint8_t hash[MSG_HASH]);

/* Note that a job of the user has these files (false: memory is out); note that
 * such a job is forgotten. */
bool known_name(struct known *k, const struct msg_hashes *files);
void known_unname(struct known *k, uint64_t now_ms,
                  const struct msg_hashes *files);

/* Write the hashes of the files that no job has and that were sent, offered or
 * last had by a job at since_ms or later into hashes, which has room for
 * k->nfree; return how many these are. */
size_t known_free(const struct known *k, uint64_t since_ms, uint8_t *hashes);

/* Forget the files that no job has and that were sent, offered or last had by a
 * job before since_ms; called now and then. */
void known_expire(struct known *k, uint64_t since_ms);

#endif
