/* msg_peer.h - the messages by which workers find each other, and their records
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_PEER_H
#define MSG_PEER_H

#include "proto/msg_basics.h"

#define MSG_PEER_DIAL (1u << 0) /* you dial; else wait for its call */
#define MSG_PEER_GIVE (1u << 1) /* send it all that your cache holds */
#define MSG_PEER_DROP (1u << 2) /* have no more to do with it; alone */

struct msg_peer {
    const char *name, *address;
    const uint8_t *token; /* MSG_TOKEN bytes, of this pair and job */
    uint32_t flags;
    uint16_t version; /* that the two speak: the highest that both do */
};

/* New peers of a job, besides those named before. */
struct msg_job_peers {
    const uint8_t *job;
    uint32_t npeers;
    const struct msg_peer *peers;
};

/* To whom a worker sends ambient records, where there are too many workers for
 * all to be linked (daemon/links/ring.h): each has a place on a ring, or one on it
 * speaks for it. */
struct msg_ring_link {
    uint32_t offset; /* so many places on; 0: one that has none */
    uint32_t below;  /* what comes from fewer places back than that goes there,
                      * at most offset; with offset 0 it is 0 */
    const char *name;
};

/* All of them: those of before do not count any more. */
struct msg_ring {
    const uint8_t *job;
    uint32_t generation;
    uint32_t places; /* on the ring; 0: this worker has none */
    uint8_t direct;  /* 1: all are linked with all besides, and what is urgent
                      * goes to each, as does all without places */
    uint32_t nlinks;
    const struct msg_ring_link *links;
};

/* The link to a worker of the ring is gone, or never came about. */
struct msg_unlinked {
    const uint8_t *job;
    const char *name;
    uint8_t was; /* 1: it was there; 0: it never came about */
};

/* Records that one worker made. */
struct msg_part {
    uint32_t distance; /* places from there to who is sent this, from 1 */
    uint32_t count;    /* records */
    const uint8_t *data;
    size_t len;
};

/* Records on their way about the ring. */
struct msg_spread {
    uint32_t generation; /* of the ring that the distances are of */
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
    uint32_t to;    /* child to radd: the GIVE that it answers, 0: all peers */
    uint32_t count; /* records */
    const uint8_t *data;
    size_t len;
};

/* Ambient records that a worker has made, for the radsubmit of a job that wants
 * them (MSG_JOB_RECORDS), by way of the coordinator. */
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
