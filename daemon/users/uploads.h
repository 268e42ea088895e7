/* uploads.h - files that users send, until a job names them
 *
 * A file is on its way from its first CHUNK to its last.  Then it waits for a
 * job of its sender that names it.  Until a job does, the file counts as the
 * sender's.  A file that waits for too long is forgotten, and the store removes
 * it; but no file of an offer is, while further files of that offer still come.
 *
 *     on its way ---> waiting ---> named by a job, or forgotten
 *          \-> gone: its connection ended, or the store failed to keep it
 *
 * Private to the coordinator's own files.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_UPLOADS_H
#define DAEMON_UPLOADS_H

#include "proto/message.h"

#include <stdbool.h>

#define UPLOADS_BUCKETS 1024 /* a power of 2 */

/* A file counts as so many bytes at least, for a small file takes a name and a
 * block of the disk, too. */
#define UPLOADS_LEAST (UINT64_C(16) << 10)

struct upload;

/* The files of one user. */
struct uploads_sum {
    uint32_t under_way; /* files on their way */
    uint64_t bytes;     /* of files on their way and of files that wait, each
                         * at least UPLOADS_LEAST */
    uint64_t offer_ms;  /* when the first of the offers under way began; if none
                         * is, of the last that were; 0: there was none */
    uint64_t moved_ms;  /* when something of these offers last came */
};

/* The files of all users; zeroed: none. */
struct uploads {
    struct upload *bucket[UPLOADS_BUCKETS]; /* hash table: lists of files */
    size_t n;                               /* files on their way or waiting */
};

void uploads_release(struct uploads *u);

/* Is the file on its way over this connection? */
bool uploads_knows(const struct uploads *u, uint64_t conn,
                   const uint8_t hash[MSG_HASH]);

/* Note that a file of `total` bytes begins to come, and count the file in
 * *payer, which must outlive it.  False: memory is out. */
bool uploads_begin(struct uploads *u, uint64_t conn,
                   const uint8_t hash[MSG_HASH], uint64_t total,
                   struct uploads_sum *payer);
/* Note that the file came whole: it waits; that it failed: it is dropped. */
void uploads_whole(struct uploads *u, uint64_t conn,
                   const uint8_t hash[MSG_HASH], uint64_t now_ms);
void uploads_failed(struct uploads *u, uint64_t conn,
                    const uint8_t hash[MSG_HASH]);
/* The connection has ended: drop the files that were on their way over it. */
void uploads_closed(struct uploads *u, uint64_t conn);

/* A job of this user names the files: they wait no more. */
void uploads_named(struct uploads *u, const struct uploads_sum *payer,
                   const struct msg_hashes *files);

/* The user has offered the file again: if it waits, it waits from now on. */
void uploads_offered(struct uploads *u, const struct uploads_sum *payer,
                     const uint8_t hash[MSG_HASH], uint64_t now_ms);

/* Files of which nothing was heard since since_ms may be forgotten: but of this
 * user, only if nothing was heard since the time that is returned.  It is
 * earlier if some of an offer came since since_ms: all files of that offer
 * stay. */
uint64_t uploads_kept_from(const struct uploads_sum *payer, uint64_t since_ms);

/* Forget files that have waited since since_ms or longer, and may be. */
void uploads_forget(struct uploads *u, uint64_t since_ms);

/* Write the hashes of all files that wait into hashes, which has room for u->n;
 * return how many these are. */
size_t uploads_waiting(const struct uploads *u, uint8_t *hashes);

#endif
