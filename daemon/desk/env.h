/* env.h - what the coordinator's machine gets from the shell around it
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ENV_H
#define DAEMON_ENV_H

#include "machine/action.h"

/* How long turns of the shell's loop took (turns.h). */
struct coord_pace {
    uint64_t slow; /* number of turns that took too long */
    double longest_ms, longest_cpu_ms;
};

/* What one user may have (quota.h); workers and admins have no limits. */
struct coord_limits {
    uint64_t jobs, frames; /* jobs that are not over, and their frames */
    uint64_t bytes;        /* on the disk, of jobs and of uploads */
    uint64_t uploads;      /* bundles and files that are being sent */
    uint64_t upload_bytes; /* of files that no job names yet */
    uint64_t conns, answers;
    uint64_t unfetched; /* jobs with pictures that the user has not fetched */
    uint64_t unread;    /* bytes of answers not read yet; the shell enforces it
                         * (fair.h) */
    uint64_t upload_ms; /* how long files wait for a job that names them, and a
                         * job for files that do not come */
};

typedef void coord_sent_fn(void *with, const uint8_t job[MSG_JOB]);

/* What the machine may ask of its shell at any time; no call may block. */
struct coord_env {
    bool (*has_file)(void *arg, const uint8_t hash[MSG_HASH]);
    void (*random)(void *arg, void *buf, size_t n); /* for tokens of peers */
    void *arg;
    action_look_fn *look; /* or NULL: has_file() answers at once */
    void (*pace)(void *arg, struct coord_pace *out); /* or NULL */
    /* bytes of answers that a user has not read; or NULL */
    uint64_t (*unread)(void *arg, const char *owner);
    /* may a further piece of an answer go out on the connection: is it read,
     * and has its user not too much unread?  NULL: always */
    bool (*has_room)(void *arg, uint64_t conn);
    /* call fn for each file of a job that is being sent; NULL: none is */
    void (*each_sent)(void *arg, coord_sent_fn *fn, void *with);
    /* for how long the machine has slept in this life of the coordinator, which
     * now_ms lacks; NULL: it never sleeps */
    uint64_t (*slept_ms)(void *arg);
    /* by how much the system's clock is ahead of the date that this life goes
     * by, since it was put right; NULL: it is right */
    int64_t (*ahead_ms)(void *arg);
    const char *program; /* "radcoord 0.1.0"; outlives the coordinator */
    uint64_t epoch;      /* number of this life of the coordinator */
    unsigned direct;     /* so many workers of a job get records of tiles from
                          * the coordinator itself; 0: 2 (feeding.c) */
    bool keeps; /* there is a store: actions tell it all that another life of
                 * the coordinator needs to go on */
    bool one_user; /* who alone has put files into the store, maybe without
                    * sending them (client/link/local.h) */
};

/* The other end of a connection, as the shell knows it. */
struct coord_peer {
    const char *address; /* for the log: "unix uid=1000", "127.0.0.1:4711" */
    const char *owner;   /* user at the other end, the owner of its jobs */
    unsigned roles;      /* bit 1u << enum msg_role: roles HELLO may ask for */
    const char *name;    /* of the only worker it may be; NULL: any */
};

/* How long jobs that are over are remembered, with their pictures
 * (bygone.c).  Each owner's jobs count by themselves. */
struct coord_keep {
    uint32_t jobs;         /* most jobs: the last so many */
    uint64_t ms;           /* for so long; 0: no limit */
    uint64_t bytes;        /* most bytes of their folders; 0: no limit */
    uint64_t unfetched_ms; /* for so long at least, if frames are not fetched */
    uint64_t cache_bytes;  /* most bytes of the ambient caches of these jobs, of
                            * all users together; 0: no caches are kept */
};

#endif
