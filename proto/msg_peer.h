/* msg_peer.h - the messages by which workers find each other, and those that
 * carry ambient records
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_PEER_H
#define MSG_PEER_H

#include "proto/msg_basics.h"

#define MSG_PEER_DIAL (1u << 0) /* dial the peer; else wait for its call */
#define MSG_PEER_GIVE (1u << 1) /* send the peer all records of your cache */
#define MSG_PEER_DROP (1u << 2) /* end the link to the peer; the only flag */

struct msg_peer {
    const char *name, *address;
    const uint8_t *token; /* MSG_TOKEN bytes, of this pair and job */
    uint32_t flags;
    uint16_t version; /* the highest that both workers speak */
};

/* New peers of a job, besides those named before. */
struct msg_job_peers {
    const uint8_t *job;
    uint32_t npeers;
    const struct msg_peer *peers;
};

/* A worker to which ambient records are sent in a job of too many workers to
 * link each with each (daemon/links/ring.h): each worker has a place on a ring,
 * or is the guest of a worker that has. */
struct msg_ring_link {
    uint32_t offset; /* places from here to that worker; 0: a guest, without a
                      * place */
    uint32_t below;  /* records made fewer places back than this go there; at
                      * most offset, and 0 for a guest */
    const char *name;
};

/* All links of a worker; they replace those of the RING before. */
struct msg_ring {
    const uint8_t *job;
    uint32_t generation;
    uint32_t places; /* on the ring; 0: this worker has no place */
    uint32_t nlinks;
    const struct msg_ring_link *links;
};

/* The link to a worker of the ring ended, or could not be made. */
struct msg_unlinked {
    const uint8_t *job;
    const char *name;
    uint8_t was; /* 1: the link ended; 0: it could not be made */
};

/* Records that one worker made. */
struct msg_part {
    uint32_t distance; /* places from the maker to the receiver, from 1 */
    uint32_t count;    /* records */
    const uint8_t *data;
    size_t len;
};

/* Records on their way about the ring. */
struct msg_spread {
    uint32_t generation; /* of the RING by which distances are counted */
    uint32_t nparts;
    const struct msg_part *parts;
};

struct msg_peer_hello {
    const uint8_t *job;
    const char *name;
    const uint8_t *token;
};

/* A batch of ambient records, opaque here (proto/ambshare.c packs them). */
struct msg_ambient {
    uint32_t to;    /* child to radd: `to` of the GIVE that this answers, or 0:
                     * to all peers */
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

/* radd to child: send every record you have, in AMBIENTs with this `to`. */
struct msg_give {
    uint32_t to;
};

#endif
