/* msg_peer.h - the messages by which workers find each other, and those that
 * carry ambient records
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_PEER_H
#define MSG_PEER_H

#include "proto/msg_basics.h"

#define MSG_PEER_DIAL (1u << 0) /* dial the peer; else the peer dials */
#define MSG_PEER_DROP (1u << 1) /* end the link to it; the only flag then */

struct msg_peer {
    const char *name, *address;
    const uint8_t *token; /* MSG_TOKEN bytes, of this pair and job */
    uint32_t flags;
    uint16_t version; /* the highest that both workers speak */
};

/* Further peers of a job; those named before remain. */
struct msg_job_peers {
    const uint8_t *job;
    uint32_t npeers;
    const struct msg_peer *peers;
};

struct msg_peer_hello {
    const uint8_t *job;
    const char *name;
    const uint8_t *token;
};

/* A batch of ambient records, opaque here (proto/ambshare.c packs them). */
struct msg_ambient {
    uint32_t count; /* records */
    const uint8_t *data;
    size_t len;
};

/* Ambient records that a worker has made, by way of the coordinator to the
 * radsubmit of a job with MSG_JOB_RECORDS. */
struct msg_records {
    const uint8_t *job;
    uint32_t count; /* records */
    const uint8_t *data;
    size_t len;
};

#endif
