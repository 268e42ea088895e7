/* known.h - which files of the store one user may know to be there
 *
 * Scenes of all users lie in one folder, by their SHA-256, and each file once.
 * That somebody else sent a file is nobody's business, and its hash alone gives
 * no right to it: so a file is there for a user as long as a job of that user,
 * that was accepted, names it, and for a while after that or after the user
 * sent the whole of it.  It stays in the store as long if nobody else needs it;
 * so what a user can learn does not depend on others.
 *
 * A set of hashes, open addressing.
 * Thread: one. */
#ifndef DAEMON_KNOWN_H
#define DAEMON_KNOWN_H

#include "proto/message.h"

#define KNOWN_MOST 65536 /* that no job names; above that the oldest go */

struct known_file;

/* Zeroed, it is empty. */
struct known {
    struct known_file *slots;
    size_t nslots; /* a power of 2, or 0 */
    size_t n;      /* files, */
    size_t nfree;  /* and those of them that no job names */
};

void known_release(struct known *k);

bool known_has(const struct known *k, const uint8_t hash[MSG_HASH]);

/* The user sent the file, or asked for one that it may know.  False: memory is
 * out. */
bool known_sent(struct known *k, uint64_t now_ms, const uint8_t hash[MSG_HASH]);

/* A job that is accepted names these; and later it is forgotten.  False: memory
 * is out. */
bool known_name(struct known *k, const struct msg_hashes *files);
void known_unname(struct known *k, uint64_t now_ms,
                  const struct msg_hashes *files);

/* Forget those that no job names, and that were sent or named before that.  Now
 * and then. */
void known_expire(struct known *k, uint64_t since_ms);

#endif
