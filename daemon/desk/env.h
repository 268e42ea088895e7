/* env.h - what the coordinator's machine is told of the world around it
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ENV_H
#define DAEMON_ENV_H

#include "machine/action.h"

/* How long the turns of the shell's loop take (turns.h). */
struct coord_pace {
    uint64_t slow; /* turns that took too long */
    double longest_ms, longest_cpu_ms;
};

/* What one user may have (quota.h), who may do no more than use the cluster. */
struct coord_limits {
    uint64_t jobs, frames; /* that are not over, and frames of these */
    uint64_t bytes;        /* on the disk */
    uint64_t uploads;      /* bundles and files on their way */
    uint64_t upload_bytes; /* of files that no job names yet */
    uint64_t conns, answers;
    uint64_t unfetched; /* jobs with pictures that it has not fetched */
    uint64_t unread;    /* bytes of answers; the shell sees to it (fair.h) */
    uint64_t upload_ms; /* so long files wait for a job that names them, and a
                         * job for files that do not come */
};

/* What the machine may ask at any time; answers must not block. */
struct coord_env {
    bool (*has_file)(void *arg, const uint8_t hash[MSG_HASH]);
    void (*random)(void *arg, void *buf, size_t n); /* tokens of peers */
    void *arg;
    action_look_fn *look; /* then coord_looked; or NULL */
    void (*pace)(void *arg, struct coord_pace *out); /* or NULL */
    /* bytes of answers that a user has not read; or NULL */
    uint64_t (*unread)(void *arg, const char *owner);
    const char *program; /* "radcoord 0.1.0"; outlives the coordinator */
    uint64_t epoch;      /* this life of the coordinator */
    unsigned all_linked; /* most workers of a job that are each linked with
                          * all others; 0: 64 (linking.h) */
    unsigned direct;     /* most workers of a job to which it sends records of
                          * tiles itself; 0: 2 (feeding.c) */
    bool keeps; /* there is a store that outlives it: what it needs to go on is
                 * told to it */
};

/* The other end of a connection, as far as the shell knows. */
struct coord_peer {
    const char *address; /* for the log: "unix uid=1000", "127.0.0.1:4711" */
    const char *owner;   /* user that its jobs belong to */
    unsigned roles;      /* bit 1u << enum msg_role: what it may ask to be */
    const char *name;    /* the only worker that it may be; NULL: any */
};

/* How long jobs that are over are remembered, with their pictures; of each
 * owner by itself (coord_keep.c). */
struct coord_keep {
    uint32_t jobs; /* the last so many */
    uint64_t ms;   /* for so long; 0: no limit */
    uint64_t
        bytes; /* of their folders on the disk, all together; 0: likewise */
    uint64_t unfetched_ms; /* what was not fetched at least so long */
    uint64_t cache_bytes; /* ambient caches of such jobs, of all users together;
                           * 0: none are kept */
};

#endif
