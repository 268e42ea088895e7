/* msg_basics.h - what messages have in common: versions, limits, and the
 * sessions in which they may arrive
 *
 * Thread: a struct belongs to one thread. */
#ifndef MSG_BASICS_H
#define MSG_BASICS_H

#include "base/error.h"
#include "proto/wire.h"

/* The current version of the protocol, and the oldest one that is still spoken.
 * A struct msg is always of the current version; only where bytes are made and
 * read the version of the connection's other side matters. */
#define MSG_VERSION     1
#define MSG_VERSION_MIN 1

#define MSG_MAX         (1u << 20) /* largest payload [bytes] */
#define MSG_MAX_CHUNK   (1u << 18) /* most file bytes in a CHUNK */
#define MSG_MAX_AMBIENT (1u << 17) /* most record bytes in an AMBIENT */
#define MSG_MAX_PIXELS  (MSG_MAX - 256) /* most pixel bytes in a RESULT */

/* String limits [bytes, without the NUL]. */
#define MSG_MAX_NAME    64
#define MSG_MAX_LABEL   4096 /* a job's name: may be a path */
#define MSG_MAX_KEY     96
#define MSG_MAX_ADDRESS 200
#define MSG_MAX_TEXT    500
#define MSG_MAX_NEEDS   1024
#define MSG_MAX_PARAMS  4096
#define MSG_MAX_ORIGIN  4096 /* header lines: where a picture is from */
#define MSG_MAX_STATE   16
#define MSG_MAX_VIEW    1024

#define MSG_MAX_FILES      16384      /* hashes in one list */
#define MSG_MAX_COSTS      (1u << 23) /* lines of a job whose costs are given */
#define MSG_MAX_FRAMES     65536      /* frames of a job */
#define MSG_MAX_VIEWS      (64u << 20) /* bytes of the file of frames */
#define MSG_MAX_WINDOWS    100000      /* windows of a job */
#define MSG_MAX_SIDE       65535       /* columns or rows that are rendered */
#define MSG_MAX_COLUMNS    ((int)MSG_MAX_PIXELS / 16) /* a row fits a RESULT */
#define MSG_MAX_OVERSAMPLE 8
#define MSG_MIN_CLAMP      1. /* least clamp, but for 0: none */
#define MSG_MAX_CLAMP      1000.

#define MSG_MAX_THREADS 4096                /* threads of a worker */
#define MSG_MAX_BYTES   (UINT64_C(1) << 50) /* bytes of a file, or a bundle */
#define MSG_MAX_DATE    UINT64_C(253402300799) /* the end of the year 9999 */

#define MSG_HASH  32 /* bytes of a SHA-256 */
#define MSG_JOB   16 /* bytes of a job's id */
#define MSG_TOKEN 16 /* bytes of a peer's token */

enum msg_type {
#define MSG(NAME, name, body, number, since, limit, at) MSG_##NAME = number,
#include "proto/message.def"
};

/* Where a message arrives: the reader, and the state of the connection. */
enum msg_session {
    MSG_AT_COORD_NEW,      /* coordinator: a connection before its HELLO */
    MSG_AT_COORD_WORKER,   /* coordinator: from a worker */
    MSG_AT_COORD_USER,     /* coordinator: from a user's radsubmit or radctl */
    MSG_AT_COORD_ADMIN,    /* coordinator: from an administrator's */
    MSG_AT_DIALLER,        /* worker or client: HELLO sent, no answer yet */
    MSG_AT_WORKER,         /* worker: from the coordinator */
    MSG_AT_CLIENT,         /* radsubmit, radctl: from the coordinator */
    MSG_AT_PEER_NEW,       /* worker: a peer's connection before PEER-HELLO */
    MSG_AT_PEER,           /* worker: from a peer of the same job */
    MSG_AT_CHILD_NEW,      /* job's child: before JOB-START */
    MSG_AT_CHILD,          /* job's child: from its radd */
    MSG_AT_PARENT_NEW,     /* radd: from a child that is not READY yet */
    MSG_AT_PARENT,         /* radd: from a child */
    MSG_AT_COORD_OBSERVER, /* coordinator: from an observer */
    MSG_NSESSION
};

enum msg_role {
    MSG_ROLE_WORKER = 1,
    MSG_ROLE_USER,
    MSG_ROLE_ADMIN,
    MSG_ROLE_OBSERVER /* sees all, changes nothing */
};

enum msg_partition {
    MSG_PART_AUTO,
    MSG_PART_STATIC,
    MSG_PART_SCANBAR,
    MSG_PART_WINDOW,
    MSG_NPART
};

/* Does it cut frames into lines, which workers share (msg_sharing.h)?  Else
 * into windows. */
static inline bool
msg_shares_lines(enum msg_partition kind)
{
    return kind != MSG_PART_WINDOW;
}

enum msg_order {
    MSG_ORDER_FORWARD,
    MSG_ORDER_BACKWARD,
    MSG_ORDER_RANDOM,
    MSG_ORDER_COST,
    MSG_NORDER
};

/* Flags of a job. */
#define MSG_JOB_DEPTH        (1u << 0) /* distances are wanted */
#define MSG_JOB_SHARE        (1u << 1) /* ambient records are shared */
#define MSG_JOB_FRESH_FRAMES (1u << 2) /* nothing is kept between frames */
#define MSG_JOB_NO_BALANCE   (1u << 3)
#define MSG_JOB_SAME_BITS    (1u << 4) /* workers' fingerprints must agree */
#define MSG_JOB_RECORDS      (1u << 5) /* RECORDS are wanted */
#define MSG_JOB_CODED        (1u << 6) /* rows come coded */
#define MSG_JOB_VIEWS        (1u << 7) /* frames and costs are in a file */
#define MSG_JOB_PASSES       (1u << 8) /* the ambient cache comes in passes */
#define MSG_JOB_SCENE        (1u << 9) /* the field `scene` names its scene */
#define MSG_JOB_REUSE        (1u << 10) /* it begins with another job's cache */
#define MSG_JOB_POINTS       (1u << 11) /* of sensor points, in a file */
#define MSG_JOB_EDGES        (1u << 12) /* pictures are wanted with edges */
#define MSG_JOB_FLAGS        8191u      /* all of them */

/* What FETCH asks for. */
enum msg_what {
    MSG_WHAT_PICTURE, /* bytes of FRAME.hdr */
    MSG_WHAT_DEPTH,   /* distances, as floats in the machine's order */
    MSG_WHAT_STATS,   /* JSON of the statistics */
    MSG_WHAT_PREVIEW, /* a .hdr of the rows so far, the others black */
    MSG_NWHAT
};

/* What QUERY asks for; the answer is JSON. */
enum msg_topic {
    MSG_QUERY_STATUS,
    MSG_QUERY_WORKERS,
    MSG_QUERY_JOBS,
    MSG_QUERY_JOB,    /* text: the job's id, or the beginning of it, in hex */
    MSG_QUERY_LIMITS, /* text: a user's name; empty: the user that asks */
    MSG_NQUERY
};

#endif
