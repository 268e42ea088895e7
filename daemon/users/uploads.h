/* uploads.h - files that users send, until a job names them
 *
 * A file is on its way from its first CHUNK to its last, and then waits for a
 * job of its sender's that names it; until that it counts as the sender's.
 * One that waits for too long is forgotten, and the store removes it.
 *
 *     on its way ---> waiting ---> named by a job, or forgotten
 *          \-> gone, with its connection or for a fault
 *
 * Private to the coordinator's own files.
 * Thread: one. */
#ifndef DAEMON_UPLOADS_H
#define DAEMON_UPLOADS_H

#include "proto/message.h"

#include <stdbool.h>

#define UPLOADS_BUCKETS 1024 /* a power of 2 */

/* A small file takes a name and a block as well. */
#define UPLOADS_LEAST (UINT64_C(16) << 10)

struct upload;

/* What one user has under way. */
struct uploads_sum {
    uint32_t under_way; /* files */
    uint64_t bytes;     /* of these and of those that wait, each at least
                         * UPLOADS_LEAST */
};

/* Zeroed, it is empty. */
struct uploads {
    struct upload *bucket[UPLOADS_BUCKETS];
    size_t n;
};

void uploads_release(struct uploads *u);

/* Is that file on its way by that connection? */
bool uploads_knows(const struct uploads *u, uint64_t conn,
                   const uint8_t hash[MSG_HASH]);

/* A file begins to come, and counts in *payer, which must outlive it.  False:
 * memory is out. */
bool uploads_begin(struct uploads *u, uint64_t conn,
                   const uint8_t hash[MSG_HASH], uint64_t total,
                   struct uploads_sum *payer);
/* The file came whole, or never will. */
void uploads_whole(struct uploads *u, uint64_t conn,
                   const uint8_t hash[MSG_HASH], uint64_t now_ms);
void uploads_failed(struct uploads *u, uint64_t conn,
                    const uint8_t hash[MSG_HASH]);
/* Nor will files that the connection sends: it is closed. */
void uploads_closed(struct uploads *u, uint64_t conn);

/* A job names these: they wait no more. */
void uploads_named(struct uploads *u, const struct uploads_sum *payer,
                   const struct msg_hashes *files);

/* Forget those that wait since then or longer. */
void uploads_forget(struct uploads *u, uint64_t since_ms);

/* The hashes of those that wait, one behind the other; how many. */
size_t uploads_waiting(const struct uploads *u, uint8_t *hashes);

#endif
