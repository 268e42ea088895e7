/* msg_store.h - the messages that carry files
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_STORE_H
#define MSG_STORE_H

#include "proto/msg_basics.h"

/* OFFER, WANT, and part of a job's spec: hashes lie one after another, MSG_HASH
 * bytes each. */
struct msg_hashes {
    uint32_t n;
    const uint8_t *hash;
};

/* A piece of a file; or of the answer to a FETCH, whose hash is zero and which
 * is known by its request id.  Pieces come in order; the last ends at total.
 * An empty file is one empty piece. */
struct msg_chunk {
    const uint8_t *hash;
    uint64_t offset, total;
    const uint8_t *data;
    size_t len;
};

/* The file is stored whole. */
struct msg_have {
    const uint8_t *hash;
};

#endif
